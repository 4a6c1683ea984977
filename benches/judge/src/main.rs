//! Robots on hills beside the same robots in a physics engine, rapier3d: how far apart they get.
//!
//! ```sh
//! # Fails beyond 3 mm, 1 degree or 2 %.
//! cargo run --release --manifest-path benches/judge/Cargo.toml
//! # Belts without springs; no verdict.
//! cargo run --release --manifest-path benches/judge/Cargo.toml -- rods
//! ```
//!
//! # What is compared
//!
//! An S4 and a Blizzard drive on 20 smooth terrains each: sums of eight waves of 2 to 6 m, with slopes of up
//! to 9 to 19 degrees, in triangles of 31 mm. They stand for 1 s, reach 0.2 m/s in another, and drive on for
//! 9 s, on every other terrain along a curve that on level ground has a radius of 1.7 m. Both sides get the
//! same rim speeds, 100 times a second. Every 0.1 s the heights of the reference points (on the ground below
//! the axle) and the upward axes are compared, and at the end the lengths of the ways. A row has the median
//! and the largest difference along a way. The verdict is on the medians over the 20 terrains, for height and
//! attitude of the largest differences.
//!
//! # The engine's robots
//!
//! The ground is a mesh of the same triangles, and each contact has Coulomb friction with the robot's
//! coefficient. Bodies have the mass, size and centre of mass that the simulator assumes, and the moments of
//! inertia of a block instead of a ball. Their outlines are left out: they touch nothing here.
//!
//! - **S4**: two balls as large as the wheels turn on joints with motors; a third one, without friction, is
//!   the castor. As three points carry it, statics determines the loads, and the engine's robot shares
//!   nothing with the simulator's model but its sizes.
//! - **Blizzard**: each belt is eight road wheels on vertical guides with springs, at the simulator's contact
//!   points and with its stiffness. They do not turn; the ground moves under them as a conveyor does. The
//!   loads of a body on more than three points depend on its springs, and a robot that skids turns by its
//!   loads, so the springs have to be equal. With `rods`, a belt is two rigid rods with round ends, which
//!   touch the ground anywhere along its edges, and the engine's solver distributes the loads arbitrarily.
//!   Straight ways still agree within millimetres, but in curves the headings part.

use std::process::ExitCode;

use roverlab::io::Result;
use roverlab::world::RobotSpec;

mod compare;
mod course;
mod engine;
mod model;
mod ours;

use compare::{Medians, Row, TITLES};
use course::Course;
use model::Stand;

/// Number of terrains for each robot.
const TERRAINS: u64 = 20;

fn main() -> ExitCode {
    let rods = std::env::args().nth(1).is_some_and(|word| word == "rods");
    let drives: &[_] = if rods {
        &[(RobotSpec::blizzard as fn() -> RobotSpec, Stand::Rods)]
    } else {
        &[(RobotSpec::s4, Stand::Springs), (RobotSpec::blizzard, Stand::Springs)]
    };
    let mut good = true;
    for (spec, stand) in drives {
        match table(&spec(), *stand) {
            Ok(within) => good &= within || rods,
            Err(error) => {
                eprintln!("{error}");
                good = false;
            }
        }
    }
    if good { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Prints the table of a robot; returns whether its medians are within the limits.
fn table(spec: &RobotSpec, stand: Stand) -> Result<bool> {
    println!("{}\n{TITLES}", spec.name);
    let mut rows = Vec::new();
    for number in 0..TERRAINS {
        let course = Course::generate(number)?;
        let ours = ours::drive(&course, spec)?;
        let theirs = engine::drive(&course, spec, stand, &ours[0]);
        let row = Row::compare(number, &course, &ours, &theirs);
        println!("{row}");
        rows.push(row);
    }
    let medians = Medians::of(&rows);
    println!("{medians}\n");
    Ok(medians.are_good(&rows))
}
