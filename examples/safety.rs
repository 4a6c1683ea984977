//! A safety system (book, sections 14.2 and 14.3) around any robot: commands reach the wheels only while it
//! is armed and started. A lost heartbeat stops it gently, a stop button at once; it goes on only when
//! somebody arms it again.
//!
//! `cargo run --release --example safety`

use std::cell::RefCell;

use roverlab::geometry::{Pose, Twist, units};
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::{Clock, Drive, Odometry};
use roverlab::safety::SafetyState::{Armed, Auto, EmergencyStop, Manual, SafeStop};
use roverlab::safety::{Heartbeat, Panel, Requests, SafetyState, Supervised, SupervisedParameters};
use roverlab::world::{RobotSpec, Scene, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::with_robot(World::walled(4.0, 1.0), RobotSpec::s4(), Pose::new(0.3, 0.5, 0.0));
    let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 1))?;
    let truth = simulation.truth();

    // The base station: what its people press at which time, and what it hears of the robot.
    let heard = RefCell::new(vec![(Manual, 0.0)]);
    let station = |now: f64, heartbeat: Heartbeat| {
        let mut heard = heard.borrow_mut();
        if heard.last().is_some_and(|&(state, _)| state != heartbeat.state) {
            let causes: Vec<&str> = heartbeat.causes.names().collect();
            let cause = if causes.is_empty() { "as asked".into() } else { causes.join(", ") };
            println!("{now:5.2} s: {:?}, {cause}", heartbeat.state);
            heard.push((heartbeat.state, now));
        }
        let within = |from: f64, to: f64| (from..to).contains(&now);
        Panel {
            // The radio link is lost for a second.
            heartbeat: (!within(3.0, 4.0)).then_some(heartbeat.count),
            requests: Requests {
                arm: within(0.2, 0.4) || within(6.0, 6.2),
                start: within(0.6, 0.8) || within(6.4, 6.6),
                disarm: false,
            },
            remote_stop: now >= 9.0,
            ..Panel::default()
        }
    };
    let parameters = SupervisedParameters::default();
    let mut car = Supervised::new(simulation.robot(0)?, station, parameters.clone())?;

    // The program knows nothing of all this; it drives on and on.
    let mut speeds = Vec::new();
    while car.now()? < 11.0 {
        car.set_speed(Twist::new(0.3, 0.0))?;
        car.wait(0.05)?;
        speeds.push((truth.time(), car.speed()?.linear));
    }
    let speed_at = |time: f64| speeds.iter().rfind(|(at, _)| *at <= time).map_or(0.0, |&(_, speed)| speed);
    for time in [0.5, 2.5, 5.5, 8.0, 10.5] {
        println!("at {time:4.1} s it drove at {:.2} m/s", speed_at(time));
    }
    let stop = car.last_stop().ok_or("it never stopped")?;
    drop(car);

    let heard = heard.into_inner();
    let states: Vec<SafetyState> = heard.iter().map(|&(state, _)| state).collect();
    assert_eq!(states, [Manual, Armed, Auto, SafeStop, Armed, Auto, EmergencyStop]);
    // The heartbeat may be missing for so long, and the robot hears of it one period later.
    let late = heard[3].1 - 3.0;
    assert!(late <= parameters.heartbeat + 2.0 * parameters.period, "{late} s");
    assert!(speed_at(2.5) > 0.25 && speed_at(5.5).abs() < 0.01 && speed_at(10.5).abs() < 0.01);
    let end = truth.robot(0)?;
    println!(
        "The last stop began at {:.2} m/s; the robot stands at {:.0} mm.",
        stop.speed,
        units::to_mm(end.pose.x)
    );
    assert_eq!(end.contacts, 0);
    Ok(())
}
