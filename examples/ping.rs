//! Messages by radio (book, section 2.12): robots pass a number around in a ring, each one more than it
//! heard, though the radio loses every fifth message.
//!
//! `cargo run --release --example ping`

use std::cell::RefCell;
use std::f64::consts::TAU;
use std::sync::Arc;

use roverlab::drive::{RadioRing, RadioRingParameters};
use roverlab::geometry::{Point, Pose, direction};
use roverlab::io::control::{Behaviour, Run};
use roverlab::io::sim::{Fleet, SimOptions};
use roverlab::picture::{Picture, Style};
use roverlab::world::{RobotPlacement, RobotSpec, Scene, World};

const ROBOTS: usize = 5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let spec = Arc::new(RobotSpec::s4());
    let mut scene = Scene::new(World::walled(1.6, 1.6));
    for robot in 0..ROBOTS {
        let angle = TAU * robot as f64 / ROBOTS as f64;
        let place = Point::new(0.8, 0.8) + direction(angle) * 0.55;
        scene.robots.push(RobotPlacement::new(Arc::clone(&spec), Pose::new(place.x, place.y, angle)));
    }
    let options = SimOptions { radio_loss: 0.2, ..SimOptions::with_noise(1.0, 1) };
    // When which robot heard which number.
    let heard = RefCell::new(Vec::new());
    let mut fleet = Fleet::new(&scene, options)?;
    for robot in 0..ROBOTS {
        let mut ring = RadioRing::new(robot == 0, RadioRingParameters::default())?;
        let (mut run, heard) = (Run::new(&ring, f64::INFINITY)?, &heard);
        fleet.control(robot, ring.period(), move |io| {
            let flow = run.step(io, &mut ring)?;
            let news = ring.take_heard().into_iter().map(|(time, number)| (time, robot, number));
            heard.borrow_mut().extend(news);
            Ok(flow.map_break(drop))
        })?;
    }
    fleet.run_for(30.0)?;
    drop(fleet);

    let mut heard = heard.into_inner();
    heard.sort_by_key(|&(_, _, number)| number);
    for &(time, robot, number) in heard.iter().take(2 * ROBOTS) {
        println!("{time:5.2} s: robot {robot} hears {number}");
    }
    let numbers = heard.iter().map(|&(_, _, number)| number);
    assert!(numbers.eq(1..=heard.len() as u32), "each number once, whatever was lost");
    println!("{} messages in 30 s", heard.len());
    assert!(heard.len() > 50);

    let mut picture = Picture::new(&scene.world);
    picture.title(format!("{} messages around a ring", heard.len()));
    for (index, robot) in scene.robots.iter().enumerate() {
        let next = scene.robots[(index + 1) % ROBOTS].pose.position();
        picture.robot(robot.pose, &spec.footprint).line([robot.pose.position(), next], Style::plan());
    }
    picture.save("target/pictures/ping.svg")?;
    Ok(())
}
