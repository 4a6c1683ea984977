use crate::ParameterError;
use crate::geometry::{Vector3, math};
use crate::kinematics::marine::{Craft, CraftMotion};
use crate::parameter::{require_not_negative, require_positive};

/// Parameters of [`DepthHold`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DepthHoldParameters {
    /// Maximum speed of the depth reference relative to its goal (m/s).
    pub speed: f64,
    /// Bandwidth of the reference (rad/s). A change of depth takes about four of its inverses longer than at
    /// constant speed.
    pub approach: f64,
    /// Bandwidth of the controller (rad/s).
    pub control: f64,
    /// Bandwidth of the observer (rad/s). Lower values average more sensor noise; higher values learn a wrong
    /// weight faster.
    pub observer: f64,
}

impl Default for DepthHoldParameters {
    /// For a craft whose thrusters have a lag of 0.2 s.
    fn default() -> Self {
        Self { speed: 0.15, approach: 0.8, control: 0.8, observer: 1.2 }
    }
}

/// Depth controller: a reference that moves to the desired depth without overshoot; an observer of depth,
/// speed and the unmodelled force; and state feedback with that force fed forward.
///
/// The observer uses the actual thrust, limits included, so nothing winds up.
///
/// ```
/// use roverlab::drive::marine::{DepthHold, DepthHoldParameters};
/// use roverlab::kinematics::marine::{Craft, CraftSpec};
///
/// let mako = Craft::new(&CraftSpec::mako(), 0.1)?;
/// let mut hold = DepthHold::new(&mako, 0.5, DepthHoldParameters::default())?;
/// let down = hold.step(0.5, 1.0, 0.1);
/// assert!(down > mako.reserve(1000.0), "more than its buoyancy, to begin the dive");
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone)]
pub struct DepthHold {
    parameters: DepthHoldParameters,
    craft: Craft,
    reserve: f64,
    lag: f64,
    /// The reference's depth, and its speed relative to the goal.
    wanted: [f64; 2],
    /// The observer's depth, speed down, and unknown force down in N.
    depth: f64,
    speed: f64,
    unknown: f64,
    /// What the thrusters push down now, and are told to.
    thrust: f64,
    command: f64,
}

/// The density of the water that the model assumes, in kg/m³; another one is learnt as a force.
const FRESH: f64 = 1000.0;
/// Reference's acceleration in terms of its speed and bandwidth.
const GENTLE: f64 = 0.5;

impl DepthHold {
    /// Creates the controller of a craft whose sensor reads `depth`. Fails for parameters out of range.
    pub fn new(craft: &Craft, depth: f64, parameters: DepthHoldParameters) -> Result<Self, ParameterError> {
        require_positive("speed", parameters.speed)?;
        require_positive("approach", parameters.approach)?;
        require_positive("control", parameters.control)?;
        require_positive("observer", parameters.observer)?;
        require_not_negative("depth", depth)?;
        let lag = craft.thrusters().iter().map(|thruster| thruster.lag).fold(0.0, f64::max);
        Ok(Self {
            parameters,
            reserve: craft.reserve(FRESH),
            craft: craft.clone(),
            lag,
            wanted: [depth, 0.0],
            depth,
            speed: 0.0,
            unknown: 0.0,
            thrust: 0.0,
            command: 0.0,
        })
    }

    /// The downward force (N) that brings a craft whose sensor reads `depth` (m) to the depth `goal` (m) and
    /// keeps it there, `seconds` after the last step.
    pub fn step(&mut self, depth: f64, goal: f64, seconds: f64) -> f64 {
        self.follow(depth, [goal, 0.0, 0.0], seconds)
    }

    /// Like [`step`](DepthHold::step), for a goal that itself moves, as with the floor below a craft that
    /// keeps its altitude: its depth (m), speed (m/s) and acceleration (m/s²) downwards.
    pub fn follow(&mut self, depth: f64, [goal, rate, bend]: [f64; 3], seconds: f64) -> f64 {
        self.observe(depth, seconds);
        self.wanted[0] += rate * seconds;
        let acceleration = self.lead(goal, seconds) + bend;
        let control = self.parameters.control;
        let off = self.wanted[0] - self.depth;
        let closing = control * control * off + 2.0 * control * (self.wanted[1] + rate - self.speed);
        let inertia = self.craft.inertia()[2];
        inertia * (acceleration + closing) + self.drag(self.speed) + self.reserve - self.unknown
    }

    /// Reports the downward force (N) commanded to the thrusters, within their limits.
    pub fn told(&mut self, force: f64) {
        self.command = force;
    }

    fn drag(&self, down: f64) -> f64 {
        let motion = CraftMotion { linear: Vector3::z() * down, angular: Vector3::zeros() };
        self.craft.drag(&motion).force.z
    }

    /// Moves the observer on by the model, and towards the reading.
    fn observe(&mut self, depth: f64, seconds: f64) {
        let inertia = self.craft.inertia()[2];
        let left = if self.lag > 0.0 { math::exp(-seconds / self.lag) } else { 0.0 };
        let mean = self.command + (self.thrust - self.command) * (1.0 - left) * self.lag / seconds;
        self.thrust = self.command + (self.thrust - self.command) * left;
        let force = mean - self.reserve + self.unknown - self.drag(self.speed);
        let acceleration = force / inertia;
        self.depth += (self.speed + 0.5 * acceleration * seconds) * seconds;
        self.speed += acceleration * seconds;
        let off = depth - self.depth;
        let rate = self.parameters.observer;
        self.depth += 3.0 * rate * seconds * off;
        self.speed += 3.0 * rate * rate * seconds * off;
        self.unknown += inertia * rate * rate * rate * seconds * off;
    }

    /// Moves the reference towards its goal; returns its acceleration.
    fn lead(&mut self, goal: f64, seconds: f64) -> f64 {
        let DepthHoldParameters { speed, approach, .. } = self.parameters;
        let wished = (0.5 * approach * (goal - self.wanted[0])).clamp(-speed, speed);
        let most = GENTLE * speed * approach * 2.0;
        let acceleration = (2.0 * approach * (wished - self.wanted[1])).clamp(-most, most);
        self.wanted[0] += (self.wanted[1] + 0.5 * acceleration * seconds) * seconds;
        self.wanted[1] += acceleration * seconds;
        acceleration
    }
}
