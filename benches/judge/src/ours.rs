use roverlab::geometry::Vector3;
use roverlab::io::sim::{SimOptions, Simulation, Truth};
use roverlab::io::{Clock, Drive, Result};
use roverlab::world::{MotorSpec, RobotSpec};

use crate::course::{BETWEEN_SAMPLES, Course, PERIOD, PERIODS, Sample};

/// Time that a command takes (s).
const CALL: f64 = 1e-6;

/// Drives a robot of the library along a course, with motors that follow each command within a tick.
pub(crate) fn drive(course: &Course, spec: &RobotSpec) -> Result<Vec<Sample>> {
    let motor = MotorSpec { time_constant: 0.0, max_acceleration: 1e3 };
    let spec = RobotSpec { motor, ..spec.clone() };
    let options = SimOptions { call_duration: CALL, ..SimOptions::ideal() };
    let simulation = Simulation::new(&course.scene(&spec), options)?;
    let (mut robot, truth) = (simulation.robot(0)?, simulation.truth());
    let mut samples = vec![sample(&truth)?];
    for period in 0..PERIODS {
        robot.set_speed(course.command(period))?;
        robot.wait(PERIOD - CALL)?;
        if (period + 1) % BETWEEN_SAMPLES == 0 {
            samples.push(sample(&truth)?);
        }
    }
    assert!((truth.time() - f64::from(PERIODS) * PERIOD).abs() < 1e-9, "{} s have passed", truth.time());
    Ok(samples)
}

fn sample(truth: &Truth) -> Result<Sample> {
    let pose = truth.pose_in_space(0)?;
    Ok(Sample { place: pose.position, up: pose.up(), ahead: pose.rotate(Vector3::x()) })
}
