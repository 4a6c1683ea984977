//! The camera, behaviours that use it, and the display.

use std::ops::ControlFlow;
use std::sync::Arc;

use roverlab::drive::colour::{ColourTracker, ColourTrackerParameters, PushHome, PushHomeParameters};
use roverlab::drive::motion_watch::{
    MotionApproach, MotionApproachParameters, MotionWatch, MotionWatchParameters,
};
use roverlab::geometry::{Pose, Twist, direction};
use roverlab::io::control::{Behaviour as _, Run, run};
use roverlab::io::sim::{Fleet, Lcd, SimOptions, Simulation};
use roverlab::io::wrappers::Traced;
use roverlab::io::{
    Camera, Clock, Display, DisplayOption, Drive, Fill, Font, Key, Keys, Odometry, Resolution, Result,
    Servos, Viewport,
};
use roverlab::vision::{CameraGeometry, ColourFinder, FindMethod, teach_hue};
use roverlab::vision::{HueScale, hue};
use roverlab::world::{Colour, Object, ObjectKind, RobotPlacement, RobotSpec, Scene, World};

use super::{Scenario, fnv, in_room, noise, note, note_truth, other, ride, room, text};

pub(super) const SCENARIOS: &[Scenario] = &[
    Scenario::new("camera", camera),
    Scenario::new("camera-sights", sights),
    Scenario::new("colour-tracking", tracking),
    Scenario::new("colour-push-home", push_home),
    Scenario::new("motion-watch", watch),
    Scenario::new("display-and-keys", display),
    Scenario::new("motion-approach", approach),
];

/// Images of three sizes, straight ahead and with the camera turned, in good and in poor light.
fn camera() -> Result<String> {
    let mut log = String::new();
    for light in [1.0, 0.4] {
        let options = SimOptions { light, ..noise(1.0, 121) };
        log += &ride(&in_room(0.5, 0.5, 0.6), options, |robot| {
            for resolution in [Resolution::Qqvga, Resolution::Qvga, Resolution::Vga] {
                robot.set_resolution(resolution)?;
                robot.image()?;
                robot.gray_image()?;
            }
            robot.set_speed(Twist::new(0.1, 0.6))?;
            for servo in [1, 2] {
                robot.set_servo(servo, 0.8)?;
                robot.wait(0.7)?;
                robot.image()?;
            }
            Ok(())
        })?;
    }
    Ok(log)
}

/// Signs, cones and other robots on the model town's floor, through a pinhole and through a fisheye, and on
/// each world that scripts know.
fn sights() -> Result<String> {
    let mut log = String::new();
    for (i, name) in World::PREDEFINED.into_iter().enumerate() {
        let mut world = World::predefined(name).expect("a world of that name");
        let middle = world.floor.min + world.floor.size() * 0.5;
        for (j, object) in ObjectKind::PREDEFINED.into_iter().enumerate() {
            let kind = Arc::new(ObjectKind::predefined(object).expect("an object of that name"));
            let heading = 0.25 * j as f64;
            let place = middle + direction(heading) * (0.5 + 0.05 * j as f64);
            world.objects.push(Object::new(kind, Pose::new(place.x, place.y, heading + 0.3)));
        }
        let mut spec = RobotSpec::s4();
        if let Some(camera) = &mut spec.camera {
            (camera.fisheye, camera.field_of_view) = (i % 2 == 1, 1.0 + 0.2 * (i % 10) as f64);
        }
        let mut scene = Scene::with_robot(world, spec, Pose::new(middle.x, middle.y, 0.0));
        let other = Pose::new(middle.x, middle.y - 0.4, 2.0);
        scene.robots.push(RobotPlacement::new(Arc::new(RobotSpec::labbot()), other));
        log += &ride(&scene, noise(0.0, 122), |robot| {
            for _ in 0..2 {
                robot.image()?;
                robot.set_servo(2, -0.4)?;
                robot.wait(1.2)?;
            }
            Ok(())
        })?;
    }
    Ok(log)
}

/// A room with high walls, and the geometry of the robot's camera.
fn coloured() -> (Scene, CameraGeometry) {
    let mut world = room();
    for wall in &mut world.walls {
        wall.height = 0.3;
    }
    let spec = RobotSpec::s4();
    let geometry = CameraGeometry::from(&spec.camera.expect("the robot has a camera"));
    (Scene::with_robot(world, spec, Pose::new(0.5, 0.4, -0.6)), geometry)
}

/// A finder for a can's red.
fn finder(method: FindMethod, geometry: CameraGeometry) -> Result<ColourFinder> {
    let red = hue([200, 24, 24], HueScale::Robios, ColourFinder::LIMITS);
    ColourFinder::new(red, 10, method, geometry).map_err(other)
}

fn tracking() -> Result<String> {
    let (scene, geometry) = coloured();
    let mut log = String::new();
    for method in [FindMethod::Blob, FindMethod::Histogram] {
        let mut seen = String::new();
        log += &ride(&scene, noise(1.0, 122), |robot| {
            let image = robot.image()?;
            note(&mut seen, "taught", &teach_hue(&image, ColourFinder::LIMITS).map_err(other)?);
            let mut tracker =
                ColourTracker::new(finder(method, geometry)?, ColourTrackerParameters::default())?;
            let outcome = run(robot, &mut tracker, 25.0, |_, tracker, _| {
                note(&mut seen, "seen", &(tracker.phase(), tracker.sighting(), tracker.target()));
            })?;
            note(&mut seen, "outcome", &outcome);
            Ok(())
        })?;
        log += &seen;
    }
    Ok(log)
}

fn push_home() -> Result<String> {
    let (scene, geometry) = coloured();
    let mut seen = String::new();
    let log = ride(&scene, SimOptions { pushing: true, ..noise(0.5, 123) }, |robot| {
        let home = robot.pose()?.position();
        let mut push =
            PushHome::new(finder(FindMethod::Blob, geometry)?, home, PushHomeParameters::default())?;
        let outcome = run(robot, &mut push, 40.0, |_, push, _| {
            note(&mut seen, "seen", &(push.phase(), push.object()));
        })?;
        note(&mut seen, "outcome", &outcome);
        Ok(())
    })?;
    Ok(log + &seen)
}

/// A robot that watches another one drive in circles.
fn watch() -> Result<String> {
    let (mut scene, geometry) = coloured();
    scene.robots[0].pose = Pose::new(0.5, 1.0, 0.0);
    scene.robots.push(RobotPlacement::new(Arc::new(RobotSpec::s4()), Pose::new(1.1, 0.8, 1.0)));
    let mut watch = MotionWatch::new(MotionWatchParameters::new(geometry.field_of_view)).map_err(other)?;
    let (mut trace, mut seen) = (Vec::new(), String::new());
    let mut fleet = Fleet::new(&scene, noise(1.0, 124))?;
    fleet.control(0, 0.1, |robot| {
        let mut robot = Traced::new(robot, &mut trace);
        let (time, image, pose) = (robot.now()?, robot.gray_image()?, robot.pose()?);
        let twist = watch.step(time, &image, pose).map_err(other)?;
        note(&mut seen, "motion", &watch.motion());
        robot.set_speed(twist)?;
        Ok(ControlFlow::Continue(()))
    })?;
    fleet.control(1, 0.5, |robot| {
        robot.set_speed(Twist::new(0.2, 0.8))?;
        Ok(ControlFlow::Continue(()))
    })?;
    fleet.run_for(8.0)?;
    let truth = fleet.truth(0)?;
    drop(fleet);
    let mut log = String::from_utf8(trace).map_err(other)? + &seen;
    note_truth(&mut log, &truth);
    Ok(log)
}

/// A robot that drives up to one which turns on the spot.
fn approach() -> Result<String> {
    let (mut scene, geometry) = coloured();
    scene.robots[0].pose = Pose::new(0.5, 1.0, 0.0);
    scene.robots.push(RobotPlacement::new(Arc::new(RobotSpec::s4()), Pose::new(1.2, 1.1, 1.0)));
    let mut approach = MotionApproach::new(MotionApproachParameters::new(geometry)).map_err(other)?;
    let (mut run, mut seen) = (Run::new(&approach, 12.0)?, String::new());
    let mut fleet = Fleet::new(&scene, noise(1.0, 125))?;
    fleet.control(0, approach.period(), |robot| {
        let flow = run.step(robot, &mut approach)?;
        note(&mut seen, "motion", &approach.motion());
        Ok(flow.map_break(drop))
    })?;
    fleet.control(1, 0.5, |robot| {
        robot.set_speed(Twist::new(0.05, 1.5))?;
        Ok(ControlFlow::Continue(()))
    })?;
    fleet.run_for(12.0)?;
    let truth = fleet.truth(0)?;
    drop(fleet);
    note_truth(&mut seen, &truth);
    Ok(seen)
}

/// All that a display draws, and keys that are pressed meanwhile.
fn display() -> Result<String> {
    let scene = Scene::with_robot(World::walled(1.0, 1.0), RobotSpec::s4(), Pose::new(0.5, 0.5, 0.0));
    let simulation = Simulation::new(&scene, SimOptions::ideal())?;
    simulation.press_key(0, 0.5, Key::Key2)?;
    simulation.press_key(0, 0.9, Key::Key4)?;
    let mut robot = Traced::new(simulation.robot(0)?, Vec::new());
    let mut frames = String::new();
    let mut shown = |robot: &mut Traced<_, _>| -> Result<()> {
        let image = Display::screenshot(robot)?;
        note(&mut frames, "frame", &fnv(image.as_raw().iter().copied()));
        Ok(())
    };
    robot.print("Hello, world\n\tand others\n")?;
    robot.set_text_colours(Colour::GREEN, Colour::BLUE)?;
    robot.set_font(Font::default())?;
    robot.print_at(5, 7, "there")?;
    shown(&mut robot)?;
    robot.draw_line((3, 200), (300, 20), Colour::GREEN)?;
    robot.draw_rectangle((20, 60), (90, 130), Colour::RED, Fill::Outline)?;
    robot.draw_rectangle((30, 70), (60, 100), Colour::RED, Fill::Solid)?;
    robot.draw_circle((200, 120), 71, Colour::BLUE, Fill::Outline)?;
    robot.draw_circle((200, 120), 40, Colour::WHITE, Fill::Solid)?;
    shown(&mut robot)?;
    let image = robot.image()?;
    robot.draw_image((&image).into(), Viewport::new((100, 50), 120, 90))?;
    robot.set_menu(["GO", "", "LEFT", "END"])?;
    robot.set_menu_label(Key::Key2, "STOP", Colour::WHITE, Colour::RED)?;
    robot.set_display_option(DisplayOption::AutoRefresh, false)?;
    robot.set_pixel((319, 0), Colour::RED)?;
    robot.pixel((319, 0))?;
    robot.cursor()?;
    robot.display_size()?;
    shown(&mut robot)?;
    robot.refresh()?;
    robot.read_key()?;
    robot.wait_key()?;
    robot.wait_key()?;
    robot.read_touch()?;
    robot.clear_display()?;
    shown(&mut robot)?;
    let sizes = Lcd::new().text_size();
    let mut log = text(robot)? + &frames;
    note(&mut log, "text", &sizes);
    Ok(log)
}
