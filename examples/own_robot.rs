//! A robot of one's own (book, chapter 2): whoever implements the traits of what a robot can do can be driven
//! by every behaviour that asks for no more. This one has a clock, speeds and odometry, and moves exactly as
//! it is told; [`Manoeuvring`] makes manoeuvres and a stall detector of that.
//!
//! `cargo run --release --example own_robot`

use roverlab::drive::{AToB, AToBOutcome, AToBParameters, Goal, Method};
use roverlab::geometry::{Pose, Twist};
use roverlab::io::control::run;
use roverlab::io::wrappers::{Manoeuvring, ManoeuvringParameters};
use roverlab::io::{Clock, Drive, Odometry, Result};
use roverlab::kinematics::{Displacement, advance};

/// Where it is, how fast it drives, and what time it is.
#[derive(Default)]
struct Tiny {
    pose: Pose,
    speed: Twist,
    time: f64,
}

impl Clock for Tiny {
    fn now(&mut self) -> Result<f64> {
        Ok(self.time)
    }

    fn wait(&mut self, seconds: f64) -> Result<()> {
        let Twist { linear, angular } = self.speed;
        self.pose = advance(self.pose, Displacement { length: linear * seconds, angle: angular * seconds });
        self.time += seconds;
        Ok(())
    }
}

impl Drive for Tiny {
    fn set_speed(&mut self, speed: Twist) -> Result<()> {
        self.speed = speed;
        Ok(())
    }
}

impl Odometry for Tiny {
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
}

fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    let goal = Pose::new(1.45, 0.65, 0.0);
    let mut robot = Manoeuvring::new(Tiny::default(), ManoeuvringParameters::default())?;
    let mut drive = AToB::new(Method::Spline, Goal::pose(goal), AToBParameters::default())?;
    let outcome = run(&mut robot, &mut drive, 60.0, |_, _, _| {})?;
    let Tiny { pose, time, .. } = robot.into_inner();
    let off = pose.distance_to(goal.position());
    println!("{outcome:?} after {time:.1} s, {:.1} mm from the goal", 1000.0 * off);
    assert!(outcome == AToBOutcome::Reached && off < 0.01);

    Ok(())
}
