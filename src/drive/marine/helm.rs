use super::{DepthHold, DepthHoldParameters, DiveObservation, Thrust};
use crate::geometry::{Vector3, angle_difference, math};
use crate::io::Result;
use crate::kinematics::marine::{Allocation, Craft, CraftMotion, CraftSpec, Wrench};

/// What steers a craft under water: its depth held and its pitch level by the upright thrusters, a push and a
/// turn by the others.
#[derive(Debug, Clone)]
pub(super) struct Helm {
    craft: Craft,
    allocation: Allocation,
    hold: Option<DepthHold>,
    hold_parameters: DepthHoldParameters,
    /// Bandwidth of the pitch (rad/s).
    turning: f64,
    depth: f64,
    /// Pitch and yaw as turn rates and readings agree.
    pitch: f64,
    yaw: f64,
    pitch_rate: f64,
    turn_rate: f64,
    /// What turn rates say it has turned since the observation before (rad).
    turned: f64,
    /// The push ahead (N) that the thrusters do.
    pushed: f64,
    before: f64,
    /// Seconds since the observation before; at first the period.
    seconds: f64,
}

/// What the level thrusters are to do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Push {
    /// Newtons forward.
    pub(super) ahead: f64,
    /// Newton metres, counter-clockwise.
    pub(super) turn: f64,
}

/// The share of the difference between a reading of the attitude and what turn rates say that a step
/// believes.
const BELIEVED: f64 = 0.1;
/// Seconds in which a difference of speed, and of turn rate, is to be closed.
const CLOSING: f64 = 0.5;
/// The least cosine of a pitch at which a craft still has a heading.
const STEEPEST: f64 = 0.1;
/// The most that a craft slips aside, as a share of its speed ahead.
const MOST_SLIP: f64 = 1.0;

impl Helm {
    pub(super) fn new(
        craft: &CraftSpec,
        turning: f64,
        period: f64,
        hold: DepthHoldParameters,
    ) -> Result<Self> {
        // The model's own step does not matter to what is asked of it.
        let craft = Craft::new(craft, 0.1)?;
        DepthHold::new(&craft, 0.0, hold)?;
        Ok(Self {
            allocation: Allocation::new(&craft),
            craft,
            hold: None,
            hold_parameters: hold,
            turning,
            depth: 0.0,
            pitch: 0.0,
            yaw: 0.0,
            pitch_rate: 0.0,
            turn_rate: 0.0,
            turned: 0.0,
            pushed: 0.0,
            before: 0.0,
            seconds: period,
        })
    }

    /// Takes notice of what is seen at a time.
    pub(super) fn observe(&mut self, time: f64, seen: &DiveObservation) -> Result<()> {
        if self.hold.is_some() {
            self.seconds = time - self.before;
        } else {
            (self.pitch, self.yaw) = (seen.attitude.pitch, seen.attitude.yaw);
            self.hold = Some(DepthHold::new(&self.craft, seen.depth, self.hold_parameters)?);
        }
        self.before = time;
        let [pitch_rate, turn_rate] = levelled(seen);
        let turned = |before: f64, now: f64| 0.5 * (before + now) * self.seconds;
        self.turned = turned(self.turn_rate, turn_rate);
        self.pitch = believed(self.pitch + turned(self.pitch_rate, pitch_rate), seen.attitude.pitch);
        self.yaw = believed(self.yaw + self.turned, seen.attitude.yaw);
        (self.depth, self.pitch_rate, self.turn_rate) = (seen.depth, pitch_rate, turn_rate);
        Ok(())
    }

    /// The heading (rad) that turn rates and readings agree on.
    pub(super) fn heading(&self) -> f64 {
        self.yaw
    }

    /// Seconds since the observation before.
    pub(super) fn seconds(&self) -> f64 {
        self.seconds
    }

    /// The angle (rad) from the heading to the way of a craft that keeps turning at a speed: it slips until
    /// the water holds it.
    pub(super) fn slip(&self, speed: f64, turn_rate: f64) -> f64 {
        let aside = |left: f64| {
            let linear = Vector3::new(speed, left, 0.0);
            let motion = CraftMotion { linear, angular: Vector3::z() * turn_rate };
            self.craft.response(&motion, &Wrench::NONE).linear.y
        };
        let (mut low, mut high) = (-MOST_SLIP * speed, MOST_SLIP * speed);
        for _ in 0..20 {
            let middle = 0.5 * (low + high);
            if aside(middle) > 0.0 { low = middle } else { high = middle }
        }
        math::atan2(low, speed)
    }

    /// The push that brings a craft, which moves ahead through the water at `speed`, to another speed and
    /// turn rate.
    pub(super) fn push(&self, speed: f64, wanted: f64, turn_rate: f64) -> Push {
        let motion = CraftMotion { linear: Vector3::x() * wanted, angular: Vector3::z() * turn_rate };
        let (drag, inertia) = (self.craft.drag(&motion), self.craft.inertia());
        Push {
            ahead: drag.force.x + inertia[0] / CLOSING * (wanted - speed),
            turn: drag.moment.z + inertia[5] / CLOSING * (turn_rate - self.turn_rate),
        }
    }

    /// The moment that turns the craft to a heading (rad) and keeps it there.
    pub(super) fn turn_to(&self, heading: f64) -> f64 {
        let off = angle_difference(heading, self.yaw);
        self.craft.inertia()[5] * self.turning * (self.turning * off - 2.0 * self.turn_rate)
    }

    /// The body that it steers.
    pub(super) fn craft(&self) -> &Craft {
        &self.craft
    }

    /// What turn rates say it has turned since the observation before (rad).
    pub(super) fn turned(&self) -> f64 {
        self.turned
    }

    /// The turn rate (rad/s) that was read.
    pub(super) fn turn_rate(&self) -> f64 {
        self.turn_rate
    }

    /// The push ahead (N) that the thrusters do since the step before.
    pub(super) fn pushed(&self) -> f64 {
        self.pushed
    }

    /// The thrusters' commands that push a boat.
    pub(super) fn afloat(&mut self, push: Push) -> Result<Thrust> {
        let along = Wrench { force: Vector3::x() * push.ahead, moment: Vector3::z() * push.turn };
        let along = self.allocation.share(&along);
        self.pushed = push.ahead * along.share;
        Thrust::new(&along.commands[..self.craft.thrusters().len()])
    }

    /// The thrusters' commands that bring the craft to a depth and push it.
    pub(super) fn thrust(&mut self, depth: f64, push: Push) -> Result<Thrust> {
        self.thrust_along([depth, 0.0, 0.0], push)
    }

    /// The thrusters' commands that keep the craft at a depth that moves with a speed and an acceleration (m,
    /// m/s, m/s²), and push it.
    pub(super) fn thrust_along(&mut self, goal: [f64; 3], push: Push) -> Result<Thrust> {
        let (turning, inertia) = (self.turning, self.craft.inertia());
        let level = inertia[4] * turning * (turning * -self.pitch - 2.0 * self.pitch_rate);
        let Some(hold) = &mut self.hold else { return Thrust::new(&[]) };
        let down = hold.follow(self.depth, goal, self.seconds);
        let upright = Wrench { force: Vector3::z() * -down, moment: Vector3::y() * level };
        let upright = self.allocation.share(&upright);
        hold.told(down * upright.share);
        let along = Wrench { force: Vector3::x() * push.ahead, moment: Vector3::z() * push.turn };
        let along = self.allocation.share(&along);
        self.pushed = push.ahead * along.share;
        let both = upright.commands.iter().zip(&along.commands);
        let commands: Vec<f64> = both.map(|(a, b)| (a + b).clamp(-1.0, 1.0)).collect();
        Thrust::new(&commands[..self.craft.thrusters().len()])
    }
}

/// How fast pitch and heading change: not as fast as a craft that rolls turns about its own axes (Fossen
/// 2021, section 2.2).
fn levelled(seen: &DiveObservation) -> [f64; 2] {
    let (sin, cos) = math::sin_cos(seen.attitude.roll);
    let upright = (seen.rates.y * sin + seen.rates.z * cos) / math::cos(seen.attitude.pitch).max(STEEPEST);
    [seen.rates.y * cos - seen.rates.z * sin, upright]
}

/// An angle between what is expected and what is read.
fn believed(expected: f64, read: f64) -> f64 {
    expected + BELIEVED * angle_difference(read, expected)
}
