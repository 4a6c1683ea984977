use std::ops::ControlFlow;

use crate::io::control::{Behaviour, Command, Decision, Halt, Senses, run};
use crate::io::{Clock, Error, Result, Servos};
use crate::parameter::require_positive;
use crate::random::Stream;

/// A cyclic servo motion (book, section 12.2): a sequence of control points, each held for the same time. An
/// initial sequence that is not repeated may lead into the cycle (section 12.5).
///
/// It is encoded in bytes, one per servo and control point: 128 is the middle, 0 and 255 are the ends.
///
/// ```
/// use roverlab::evolve::Gait;
/// let gait = Gait::from_bytes(&[128, 128, 0, 255], 2, 0)?;
/// assert_eq!(gait.point(0), [0.0, 0.0]);
/// assert_eq!(gait.point(3), [-1.0, 127.0 / 128.0]);
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Gait {
    positions: Vec<f64>,
    servos: usize,
    leading: usize,
}

/// Maximum size of a gait (bytes).
const MOST: usize = 1_000_000;

impl Gait {
    /// Time for which a control point is held (s).
    pub const PERIOD: f64 = 0.25;
    /// Time to come to rest at the first control point (s).
    pub const SETTLING: f64 = 2.0;
    /// Middle of a servo's range, as a byte.
    const MIDDLE: i32 = 128;

    /// Decodes a gait of `servos` servos; the first `leading` control points are not repeated.
    ///
    /// # Errors
    ///
    /// If the bytes are not whole control points, or none of them is repeated.
    pub fn from_bytes(bytes: &[u8], servos: usize, leading: usize) -> Result<Self> {
        let whole = servos > 0
            && bytes.len().is_multiple_of(servos)
            && leading.checked_mul(servos).is_some_and(|once| bytes.len() > once);
        if !whole {
            let expected = format!("a multiple of {servos} servos, more than {leading} control points");
            return Err(Error::invalid_input(
                "length of a gait",
                format!("{} bytes", bytes.len()),
                &expected,
            ));
        }
        let position = |byte: &u8| f64::from(i32::from(*byte) - Self::MIDDLE) / f64::from(Self::MIDDLE);
        Ok(Self { positions: bytes.iter().map(position).collect(), servos, leading })
    }

    /// Random bytes near the middle: each control point differs from the one before by at most `step` (5 in
    /// the book).
    ///
    /// # Errors
    ///
    /// If these are more than a million bytes.
    pub fn near_middle(servos: usize, points: usize, step: u8, random: &mut Stream) -> Result<Vec<u8>> {
        if servos.saturating_mul(points.max(1)) > MOST {
            let found = format!("{servos} servos at {points} control points");
            return Err(Error::invalid_input("length of a gait", found, &format!("at most {MOST} bytes")));
        }
        let mut bytes = vec![Self::MIDDLE as u8; servos];
        let changes = 2 * usize::from(step) + 1;
        for i in servos..servos * points {
            let change = random.below(changes) as i32 - i32::from(step);
            bytes.push((i32::from(bytes[i - servos]) + change).clamp(0, 255) as u8);
        }
        bytes.truncate(servos * points);
        Ok(bytes)
    }

    /// Servo positions, -1 to 1, at a control point of the endless sequence.
    pub fn point(&self, index: usize) -> &[f64] {
        let points = self.positions.len() / self.servos;
        let at =
            if index < points { index } else { self.leading + (index - points) % (points - self.leading) };
        &self.positions[at * self.servos..][..self.servos]
    }

    /// Moves a robot to the first control point and waits [`SETTLING`](Self::SETTLING) for it to come to
    /// rest.
    ///
    /// # Errors
    ///
    /// If the robot reports one.
    pub fn settle<R: Clock + Servos + ?Sized>(&self, robot: &mut R) -> Result<()> {
        let mut stand = GaitWalk { gait: self, next: 0, period: Self::SETTLING };
        run(robot, &mut stand, Self::SETTLING, |_, _, _| {}).map(|_| ())
    }

    /// Moves a settled robot for `seconds`, from the second control point on.
    ///
    /// # Errors
    ///
    /// If `seconds` is not positive and finite, or the robot reports an error.
    pub fn walk<R: Clock + Servos + ?Sized>(&self, robot: &mut R, seconds: f64) -> Result<()> {
        require_positive("time to walk", seconds)?;
        run(robot, &mut self.walking(), seconds, |_, _, _| {}).map(|_| ())
    }

    /// The gait as a behaviour of a settled robot, from the second control point on.
    pub fn walking(&self) -> GaitWalk<'_> {
        GaitWalk { gait: self, next: 1, period: Self::PERIOD }
    }
}

/// Behaviour that walks a [`Gait`]; see [`Gait::walking`].
///
/// ```
/// use std::ops::ControlFlow;
/// use roverlab::evolve::{Gait, GaitWalk, ServoPositions};
/// use roverlab::io::control::Behaviour;
/// let gait = Gait::from_bytes(&[128, 128, 0, 192], 2, 0)?;
/// let mut walk: GaitWalk<'_> = gait.walking();
/// assert_eq!(walk.step(0.0, &())?, ControlFlow::Continue(ServoPositions(&[-1.0, 0.5])));
/// assert_eq!(walk.step(0.25, &())?, ControlFlow::Continue(ServoPositions(&[0.0, 0.0])), "round and round");
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct GaitWalk<'g> {
    gait: &'g Gait,
    next: usize,
    period: f64,
}

impl<'g> Behaviour for GaitWalk<'g> {
    type Observation = ();
    type Command = ServoPositions<'g>;
    type Outcome = Halt;

    fn period(&self) -> f64 {
        self.period
    }

    fn step(&mut self, _time: f64, (): &()) -> Decision<Self> {
        self.next += 1;
        Ok(ControlFlow::Continue(ServoPositions(self.gait.point(self.next - 1))))
    }
}

impl<R: ?Sized> Senses<R> for GaitWalk<'_> {
    fn sense(&mut self, _robot: &mut R, _time: f64, (): &mut ()) -> Result<()> {
        Ok(())
    }
}

/// Target positions of the servos, from the first one on: -1 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ServoPositions<'p>(pub &'p [f64]);

impl<R: Servos + ?Sized> Command<R> for ServoPositions<'_> {
    fn apply(&self, robot: &mut R) -> Result<()> {
        (1..).zip(self.0).try_for_each(|(servo, position)| robot.set_servo(servo, *position))
    }

    /// Servos hold their position.
    fn stop(_robot: &mut R) -> Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::{Call, MockRobot};
    use proptest::prelude::*;

    #[test]
    fn what_leads_is_done_once_and_the_rest_again_and_again() {
        let gait = Gait::from_bytes(&[10, 20, 30, 40], 1, 1).unwrap();
        let order: Vec<f64> = (0..9).map(|i| gait.point(i)[0] * 128.0 + 128.0).collect();
        assert_eq!(order, [10.0, 20.0, 30.0, 40.0, 20.0, 30.0, 40.0, 20.0, 30.0]);
    }

    #[test]
    fn lengths_that_make_no_gait_are_named() {
        let text =
            |bytes: &[u8], servos, leading| Gait::from_bytes(bytes, servos, leading).unwrap_err().to_string();
        assert!(
            text(&[1; 7], 5, 0).starts_with("length of a gait is 7 bytes; expected a multiple of 5 servos")
        );
        assert!(text(&[1; 10], 5, 2).ends_with("more than 2 control points"));
        assert!(text(&[], 5, 0).starts_with("length of a gait is 0 bytes"));
    }

    #[test]
    fn a_robot_settles_and_then_walks_for_as_long_as_it_shall() {
        let mut robot = MockRobot::new();
        let gait = Gait::from_bytes(&[128, 0, 255], 1, 0).unwrap();
        gait.settle(&mut robot).unwrap();
        gait.walk(&mut robot, 1.0).unwrap();
        assert!((robot.now().unwrap() - 3.0).abs() < 1e-6);
        let sent = robot.calls().iter().filter(|call| matches!(call, Call::SetServo(..))).count();
        assert_eq!(sent, 5, "one to settle, four of a quarter of a second");
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn near_the_middle_steps_are_small(step in 0..20_u8, points in 1..12_usize, seed: u64) {
            let bytes = Gait::near_middle(5, points, step, &mut Stream::new(seed)).unwrap();
            prop_assert_eq!(bytes.len(), 5 * points);
            prop_assert!(bytes[..5].iter().all(|&byte| byte == 128));
            prop_assert!(bytes.windows(6).all(|w| w[0].abs_diff(w[5]) <= step));
        }
    }
}
