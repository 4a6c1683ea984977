use image::RgbImage;

use super::film::Film;
use super::fisheye::{Fisheye, Gaze};
use super::studio::Studio;
use super::view::View;
use crate::geometry::{Point3, Pose, Pose3, units};
use crate::io::camera::FRAME_RATE;
use crate::io::sim::terrain::Hills;
use crate::io::sim::{NoiseModel, SERVO_RATE, TICKS_PER_SECOND};
use crate::io::{Error, ErrorKind, Resolution, Result};
use crate::random::Stream;
use crate::world::space::Space;
use crate::world::{CameraSpec, Mount};

/// A robot's camera on its pan-tilt head.
#[derive(Debug)]
pub(in crate::io::sim) struct CameraDevice {
    spec: CameraSpec,
    /// Height of the robot's foot above the world's floor (m).
    elevation: f64,
    pub(in crate::io::sim) resolution: Resolution,
    pan: Servo,
    tilt: Servo,
    film: Film,
    /// The lens; `None` for a pinhole camera.
    fisheye: Option<Box<Fisheye>>,
    /// The last image and its frame number.
    last: Option<(u64, RgbImage)>,
}

/// Pictures of a pinhole camera grow without end towards 180 degrees.
const WIDEST: f64 = 170.0;

/// Time and light of an image.
#[derive(Debug, Clone, Copy)]
pub(in crate::io::sim) struct Moment<'a> {
    pub(in crate::io::sim) tick: u64,
    pub(in crate::io::sim) light: f64,
    pub(in crate::io::sim) noise: &'a NoiseModel,
}

/// A servo that turns at a constant rate from its old position to the commanded one.
#[derive(Debug, Clone, Copy, Default)]
struct Servo {
    from: f64,
    to: f64,
    since: u64,
}

impl Servo {
    fn angle(&self, tick: u64) -> f64 {
        let ticks = tick.saturating_sub(self.since) as f64;
        let most = units::from_deg(SERVO_RATE) * ticks / TICKS_PER_SECOND;
        let missing = self.to - self.from;
        if missing.abs() <= most { self.to } else { self.from + most.copysign(missing) }
    }

    fn turn_to(&mut self, angle: f64, tick: u64) {
        *self = Self { from: self.angle(tick), to: angle, since: tick };
    }
}

impl CameraDevice {
    pub(in crate::io::sim) fn new(spec: CameraSpec, elevation: f64, stream: Stream) -> Self {
        Self {
            spec,
            elevation,
            resolution: Resolution::default(),
            pan: Servo::default(),
            tilt: Servo::default(),
            film: Film::new(stream),
            fisheye: spec.fisheye.then(|| Box::new(Fisheye::new())),
            last: None,
        }
    }

    /// Turns the head: servo 1 pans, servo 2 tilts. Positive positions are to the right and up.
    pub(in crate::io::sim) fn set_servo(&mut self, servo: u8, position: f64, tick: u64) -> Result<()> {
        let (head, angle) = match servo {
            1 => (&mut self.pan, -position * self.spec.max_pan),
            2 => (&mut self.tilt, position * self.spec.max_tilt),
            _ => return Err(Error::unsupported("such servo")),
        };
        if !(-1.0..=1.0).contains(&position) {
            return Err(Error::invalid_input("servo position", position, "-1 to 1"));
        }
        head.turn_to(angle, tick);
        Ok(())
    }

    /// The image of the present frame for a robot at a pose; taken at the first request.
    pub(in crate::io::sim) fn take(
        &mut self,
        studio: &mut Studio,
        (space, hills): (&Space, Option<&Hills>),
        (index, pose): (usize, Pose),
        moment: Moment<'_>,
        image: &mut RgbImage,
    ) -> Result<()> {
        let frame = (moment.tick as f64 * FRAME_RATE / TICKS_PER_SECOND) as u64;
        match &self.last {
            Some((taken, last)) if *taken == frame && last.dimensions() == self.resolution.dimensions() => {
                copy(last, image);
                return Ok(());
            }
            _ => {}
        }
        let gaze = self.gaze(&pose, hills.map(|hills| hills.pose(index)), moment.tick)?;
        let Studio { scenery, canvas, side, darkroom } = studio;
        if let Some(lens) = &mut self.fisheye {
            lens.draw((canvas, side), scenery, &gaze, (space, hills), index)?;
        } else {
            let view = View::new(gaze.eye, gaze.heading, gaze.tilt, gaze.field_of_view, gaze.dimensions);
            scenery.draw(canvas, &view.rolled(gaze.roll), (space, hills), index)?;
        }
        let time = moment.tick as f64 / TICKS_PER_SECOND;
        self.film.develop(canvas, time, moment.light, moment.noise, darkroom, image);
        let (taken, last) = self.last.get_or_insert_default();
        *taken = frame;
        copy(image, last);
        Ok(())
    }

    fn gaze(&self, robot: &Pose, on_hills: Option<Pose3>, tick: u64) -> Result<Gaze> {
        let spec = &self.spec;
        let widest = if spec.fisheye { 360.0 } else { WIDEST };
        if !(spec.field_of_view > 0.0 && spec.field_of_view <= units::from_deg(widest)) {
            let found = units::to_deg(spec.field_of_view);
            let message = format!(
                "the simulator draws what cameras of at most {widest} degrees see; this one's view is {found} degrees"
            );
            return Err(Error::new(ErrorKind::Unsupported, message));
        }
        let Mount { x, y, z, yaw, .. } = spec.mount;
        let (pan, tilt) = (self.pan.angle(tick), spec.tilt + self.tilt.angle(tick));
        let (field_of_view, dimensions) = (spec.field_of_view, self.resolution.dimensions());
        if let Some(robot) = on_hills {
            let head = Pose3::from_angles(Point3::new(x, y, z), 0.0, -tilt, yaw + pan);
            let head = robot.compose(&head);
            let ([roll, pitch, heading], eye) = (head.roll_pitch_yaw(), head.position.into());
            return Ok(Gaze { eye, heading, tilt: -pitch, roll, field_of_view, dimensions });
        }
        let place = robot.compose(&Pose::new(x, y, yaw));
        let eye = [place.x, place.y, self.elevation + z];
        Ok(Gaze { eye, heading: place.heading + pan, tilt, roll: 0.0, field_of_view, dimensions })
    }
}

/// Copies an image, reusing the destination's memory if the size is equal.
fn copy(from: &RgbImage, to: &mut RgbImage) {
    if from.dimensions() == to.dimensions() {
        to.copy_from_slice(from);
    } else {
        to.clone_from(from);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_servo_takes_three_seconds_for_a_right_angle() {
        let mut servo = Servo::default();
        servo.turn_to(units::from_deg(90.0), 100);
        for (tick, degrees) in [(100, 0.0), (200, 30.0), (399, 89.7), (400, 90.0), (5000, 90.0)] {
            assert!((units::to_deg(servo.angle(tick)) - degrees).abs() < 1e-9, "{tick}");
        }
        servo.turn_to(0.0, 200);
        assert!(servo.angle(250) > 0.0 && servo.angle(300) == 0.0);
    }
}
