//! A robot of one's own (book, chapter 2): whoever implements the traits of what a robot can do can be driven
//! by every behaviour that asks for no more. This one has a clock and a drive, and moves exactly as it is
//! told.
//!
//! `cargo run --release --example own_robot`

use roverlab::drive::{AToB, AToBOutcome, AToBParameters, Goal, Method};
use roverlab::geometry::{Pose, Twist};
use roverlab::io::control::run;
use roverlab::io::{Clock, Drive, Result};
use roverlab::kinematics::{Displacement, advance};

/// Where it is, how fast it drives, and what time it is.
#[derive(Default)]
struct Tiny {
    pose: Pose,
    speed: Twist,
    time: f64,
}

impl Tiny {
    fn go(&mut self, length: f64, angle: f64, seconds: f64) {
        self.pose = advance(self.pose, Displacement { length, angle });
        self.time += seconds;
    }
}

impl Clock for Tiny {
    fn now(&mut self) -> Result<f64> {
        Ok(self.time)
    }

    fn wait(&mut self, seconds: f64) -> Result<()> {
        self.go(self.speed.linear * seconds, self.speed.angular * seconds, seconds);
        Ok(())
    }
}

impl Drive for Tiny {
    fn set_speed(&mut self, speed: Twist) -> Result<()> {
        self.speed = speed;
        Ok(())
    }

    fn speed(&mut self) -> Result<Twist> {
        Ok(self.speed)
    }

    fn pose(&mut self) -> Result<Pose> {
        Ok(self.pose)
    }

    fn set_pose(&mut self, pose: Pose) -> Result<()> {
        self.pose = pose;
        Ok(())
    }

    // Manoeuvres are over at once: the time that they take has passed when the call returns.
    fn straight(&mut self, distance: f64, speed: f64) -> Result<()> {
        self.curve(distance, 0.0, speed)
    }

    fn turn(&mut self, angle: f64, speed: f64) -> Result<()> {
        self.speed = Twist::STOP;
        self.go(0.0, angle, (angle / speed).abs());
        Ok(())
    }

    fn curve(&mut self, length: f64, angle: f64, speed: f64) -> Result<()> {
        self.speed = Twist::STOP;
        self.go(length, angle, (length / speed).abs());
        Ok(())
    }

    fn remaining(&mut self) -> Result<f64> {
        Ok(0.0)
    }

    fn is_done(&mut self) -> Result<bool> {
        Ok(true)
    }

    fn wait_done(&mut self) -> Result<()> {
        Ok(())
    }

    fn is_stalled(&mut self) -> Result<bool> {
        Ok(false)
    }
}

fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    let goal = Pose::new(1.45, 0.65, 0.0);
    let mut robot = Tiny::default();
    let mut drive = AToB::new(Method::Spline, Goal::pose(goal), AToBParameters::default())?;
    let outcome = run(&mut robot, &mut drive, 60.0, |_, _, _| {})?;
    let off = robot.pose.distance_to(goal.position());
    println!("{outcome:?} after {:.1} s, {:.1} mm from the goal", robot.time, 1000.0 * off);
    assert!(outcome == AToBOutcome::Reached && off < 0.01);

    Ok(())
}
