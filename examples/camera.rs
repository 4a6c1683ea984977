//! A robot's camera (book, section 11.1): it takes an image, shows it on its display, turns its head, and
//! takes another one. The images are in `target/pictures/`.
//!
//! `cargo run --release --example camera`

use std::sync::Arc;

use roverlab::geometry::{Pose, units};
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::{Camera, Clock, Display, DisplayImage, Resolution, Servos, Viewport};
use roverlab::world::{Colour, Object, ObjectKind, RobotSpec, Scene, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut world = World::walled(4.0, 3.0);
    for (wall, colour) in world.walls.iter_mut().zip([0xe8_d9_b8, 0xb9_cd_c4, 0xd8_b4_a0, 0xc6_c8_dc]) {
        (wall.height, wall.colour) = (0.5, Colour::from_hex(colour));
    }
    for (name, x, y) in [("can", 1.1, 1.5), ("crate", 2.4, 1.0), ("soccer", 1.6, 2.3), ("can", 0.9, 2.1)] {
        let kind = ObjectKind::predefined(name).ok_or("no such object")?;
        world.objects.push(Object::new(Arc::new(kind), Pose::new(x, y, 0.4)));
    }
    let scene = Scene::with_robot(world, RobotSpec::s4(), Pose::new(0.5, 1.5, 0.0));
    let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 1))?;
    let mut robot = simulation.robot(0)?;

    robot.set_resolution(Resolution::Qvga)?;
    let ahead = robot.image()?;
    let (width, height) = ahead.dimensions();
    let [red, green, blue] = ahead.get_pixel(width / 2, height / 2).0;
    println!("{width} x {height} pixels; the one in the middle has red {red}, green {green}, blue {blue}");
    // A red can stands straight ahead.
    assert!(red > 2 * green.max(blue));

    // The head's pan servo is number 1: its whole range is -1 to 1, 90 degrees to the left being -1.
    let pan = 45.0;
    robot.set_servo(1, -pan / 90.0)?;
    robot.wait(5.0)?;
    let aside = robot.image()?;
    let gray = robot.gray_image()?;
    let mean = gray.pixels().map(|pixel| f64::from(pixel.0[0])).sum::<f64>() / f64::from(width * height);
    println!("with the head {pan:.0} degrees to the left, the mean brightness is {mean:.0} of 255");
    assert!(aside != ahead && (40.0..220.0).contains(&mean));
    let heading = units::to_deg(simulation.truth().pose(0)?.heading);
    assert!(heading.abs() < 0.01, "the robot itself has not turned");

    robot.draw_image(DisplayImage::Rgb(&aside), Viewport::default())?;
    robot.set_menu(["", "", "", "END"])?;
    std::fs::create_dir_all("target/pictures")?;
    ahead.save("target/pictures/camera.png")?;
    robot.screenshot()?.save("target/pictures/camera_display.png")?;
    Ok(())
}
