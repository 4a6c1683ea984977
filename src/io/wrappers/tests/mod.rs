mod faults;
mod identity;
mod limits;
mod manoeuvres;
mod noise;
mod traces;

use crate::geometry::{Pose, Twist, Vector3};
use crate::io::{
    Attitude, DisplayOption, Fill, Font, Key, LidarScan, LidarSettings, MockRobot, Psd, RadioMessage,
    Resolution, RobotIo, Script, Viewport,
};
use crate::world::Colour;

/// A mock with readings that change with time and calls that take some time.
fn busy_robot() -> MockRobot {
    let scan = |time: f64| LidarScan {
        angle_min: -1.0,
        angle_increment: 0.5,
        range_max: 5.0,
        mount: Pose::new(0.1, 0.0, 0.0),
        ranges: vec![1.0 + time, f64::INFINITY, 0.3, 5.0, 2.0],
    };
    let message = |at: f64| (at, RadioMessage { from: 2, data: vec![7, 0, 255] });
    MockRobot::new()
        .with_call_charge(0.001)
        .with_distance(Psd::FRONT, Script::function(|time| Ok(0.5 + 0.1 * time)))
        .with_distance(Psd::LEFT, f64::INFINITY)
        .with_scan(Script::function(move |time| Ok(scan(time))))
        .with_image(Script::function(|time| {
            Ok(image::RgbImage::from_pixel(4, 3, image::Rgb([(50.0 * time) as u8, 200, 0])))
        }))
        .with_encoder(1, Script::function(|time| Ok((1000.0 * time) as i64)))
        .with_attitude(Script::function(|time| Ok(Attitude { roll: 0.1 * time, pitch: -0.2, yaw: time })))
        .with_turn_rates(Script::function(|time| Ok(Vector3::new(time, 0.5, -time))))
        .with_depth(Script::function(|time| Ok(0.5 + 0.1 * time)))
        .with_acceleration(Script::function(|time| Ok(Vector3::new(0.1, time, 9.81))))
        .with_keys([(0.0, Key::Key1), (0.4, Key::Key3), (1.0, Key::Key4)])
        .with_touches([(0.2, (3, 4))])
        .with_radio(1, [1, 2], [message(0.1), message(0.5)])
        .with_ideal_drive()
}

const CALLS: u8 = 44;

/// Makes one of all possible calls and returns its answer.
fn call(robot: &mut (impl RobotIo + ?Sized), number: u8) -> String {
    let colours = (Colour::RED, Colour::BLUE);
    let image = image::RgbImage::from_pixel(3, 2, image::Rgb([1, 2, 3]));
    let settings = LidarSettings { field_of_view: 1.0, tilt: 0.0, points: 5 };
    match number % CALLS {
        0 => format!("{:?}", robot.now()),
        1 => format!("{:?}", robot.wait(0.25)),
        2 => format!("{:?}", robot.set_speed(Twist::new(0.2, -0.3))),
        3 => format!("{:?}", robot.speed()),
        4 => format!("{:?}", robot.pose()),
        5 => format!("{:?}", robot.set_pose(Pose::new(1.0, 2.0, 0.5))),
        6 => format!("{:?}", robot.straight(0.1, 0.2)),
        7 => format!("{:?}", robot.turn(-0.5, 1.0)),
        8 => format!("{:?}", robot.curve(0.2, 0.5, 0.1)),
        9 => format!("{:?}", robot.drive_to(0.1, 0.05, 0.1)),
        10 => format!("{:?}", robot.remaining()),
        11 => format!("{:?}", robot.is_done()),
        12 => format!("{:?}", robot.wait_done()),
        13 => format!("{:?}", robot.is_stalled()),
        14 => format!("{:?}", robot.distance(Psd::FRONT)),
        15 => format!("{:?}", robot.distance(Psd::LEFT)),
        16 => format!("{:?}", robot.distance(Psd(9)).map_err(|e| e.to_string())),
        17 => format!("{:?}", robot.scan()),
        18 => format!("{:?}", robot.configure_lidar(settings)),
        19 => format!("{:?}", robot.print("hello\n")),
        20 => format!("{:?}", robot.print_at(3, 4, "there")),
        21 => format!("{:?} {:?}", robot.set_cursor(1, 2), robot.cursor()),
        22 => format!("{:?}", robot.set_text_colours(colours.0, colours.1)),
        23 => format!("{:?}", robot.set_font(Font::default())),
        24 => format!("{:?} {:?}", robot.clear_display(), robot.display_size()),
        25 => format!("{:?} {:?}", robot.set_pixel((1, 1), colours.0), robot.pixel((1, 1))),
        26 => format!("{:?}", robot.draw_line((0, 0), (9, 9), colours.0)),
        27 => format!("{:?}", robot.draw_rectangle((0, 0), (9, 9), colours.0, Fill::Solid)),
        28 => format!("{:?}", robot.draw_circle((50, 50), 9, colours.0, Fill::Outline)),
        29 => format!("{:?}", robot.draw_image((&image).into(), Viewport::default())),
        30 => format!("{:?}", robot.set_menu_label(Key::Key2, "GO", colours.0, colours.1)),
        31 => format!("{:?}", robot.set_menu(["a", "b", "", "END"])),
        32 => format!("{:?}", robot.set_display_option(DisplayOption::AutoRefresh, false)),
        33 => format!("{:?} {:?}", robot.refresh(), robot.screenshot().map(|i| i.dimensions())),
        34 => format!("{:?} {:?}", robot.read_key(), robot.read_touch()),
        35 => format!("{:?}", robot.wait_key().map_err(|e| e.to_string())),
        36 => format!("{:?} {:?} {:?}", robot.radio_id(), robot.radio_peers(), robot.receive()),
        37 => format!("{:?}", robot.send(2, b"hi")),
        38 => format!("{:?} {:?}", robot.set_motor(1, 0.5), robot.set_servo(1, -0.5)),
        39 => format!("{:?} {:?}", robot.encoder(1), robot.reset_encoder(1)),
        40 => format!("{:?} {:?}", robot.set_resolution(Resolution::Vga), robot.resolution()),
        42 => format!("{:?}", robot.depth()),
        41 => format!("{:?}", robot.image()),
        _ => format!("{:?} {:?} {:?}", robot.attitude(), robot.turn_rates(), robot.acceleration()),
    }
}

fn calls(robot: &mut (impl RobotIo + ?Sized), numbers: &[u8]) -> Vec<String> {
    numbers.iter().map(|&number| call(robot, number)).collect()
}
