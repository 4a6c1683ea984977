use crate::geometry::{Point, Pose, Twist, math};
use crate::io::{Error, Result};

/// How a racing car moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum CarModel {
    /// The wheels roll without slip, whatever the speed.
    Kinematic,
    /// Tyres slip, and their forces stay within the friction circle.
    #[default]
    Dynamic,
}

/// A racing car. The defaults are those of a student's Formula car with a motor at each wheel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RaceCarSpec {
    /// How it moves.
    pub model: CarModel,
    /// Metres from the centre of mass to the front axle.
    pub front: f64,
    /// Metres from the centre of mass to the rear axle.
    pub rear: f64,
    /// The radius of gyration around the vertical, in metres.
    pub gyration: f64,
    /// Metres from the rear axle to the nose.
    pub nose: f64,
    /// Metres from the rear axle to the tail.
    pub tail: f64,
    /// Metres from side to side.
    pub width: f64,
    /// The friction circle's radius as an acceleration, in m/s².
    pub grip: f64,
    /// Force of a tyre across, for a load and a slip angle, in 1/rad.
    pub stiffness: f64,
    /// Grip and stiffness of the front tyres as a share of that of the rear ones: less than 1, so that the front slides first.
    pub balance: f64,
    /// The greatest acceleration by the motors, in m/s².
    pub drive: f64,
    /// The greatest deceleration by the brakes, in m/s².
    pub brake: f64,
    /// Metres per second at most.
    pub top_speed: f64,
    /// The largest steering angle in radians.
    pub max_steering: f64,
    /// Radians per second at which the steering turns.
    pub steering_rate: f64,
    /// How many m/s² the controller of the motors asks for, for a speed that is wrong by 1 m/s.
    pub speed_gain: f64,
}

impl Default for RaceCarSpec {
    fn default() -> Self {
        Self {
            model: CarModel::Dynamic,
            front: 0.80,
            rear: 0.75,
            gyration: 0.70,
            nose: 2.15,
            tail: 0.45,
            width: 1.40,
            grip: 12.0,
            stiffness: 22.0,
            balance: 0.9,
            drive: 8.0,
            brake: 11.0,
            top_speed: 30.0,
            max_steering: 0.60,
            steering_rate: 2.0,
            speed_gain: 12.0,
        }
    }
}

impl RaceCarSpec {
    /// Metres between the axles.
    pub fn wheelbase(&self) -> f64 {
        self.front + self.rear
    }

    /// The greatest acceleration across in balance, in m/s², on bends that are wide for the car: no steering angle gives more.
    pub fn cornering(&self) -> f64 {
        let (mut least, mut most) = (0.0, self.grip);
        for _ in 0..40 {
            let middle = 0.5 * (least + most);
            if self.balances(middle) { least = middle } else { most = middle }
        }
        least
    }

    /// Whether tyres hold an acceleration across.
    fn balances(&self, across: f64) -> bool {
        let stiffness = self.stiffness * GRAVITY;
        let strained = across / self.grip;
        if strained >= 1.0 {
            return false;
        }
        let rear = across / (stiffness * (1.0 - strained * strained).sqrt());
        // The front axle gives more the more it slips, and less the more it is turned.
        (0..400).any(|k| {
            let slip = self.max_steering * 2.0 * f64::from(k) / 400.0;
            let steering = slip - rear;
            let linear = stiffness * slip / self.grip;
            let force = self.balance * self.grip * linear / (1.0 + linear * linear).sqrt();
            steering <= self.max_steering && force * math::cos(steering) >= across
        })
    }

    /// Fails with the name of the number that is out of range.
    pub(super) fn validate(&self) -> Result<()> {
        for (name, value) in [
            ("distance to the front axle", self.front),
            ("distance to the rear axle", self.rear),
            ("radius of gyration", self.gyration),
            ("nose", self.nose),
            ("tail", self.tail),
            ("width", self.width),
            ("grip", self.grip),
            ("stiffness", self.stiffness),
            ("balance of the tyres", self.balance),
            ("drive", self.drive),
            ("brake", self.brake),
            ("top speed", self.top_speed),
            ("maximal steering", self.max_steering),
            ("steering rate", self.steering_rate),
            ("speed gain", self.speed_gain),
        ] {
            if !(value.is_finite() && value > 0.0 && value < 1000.0) {
                return Err(Error::invalid_input(name, value, "more than 0 and less than 1000"));
            }
        }
        if self.max_steering > 1.4 {
            return Err(Error::invalid_input("maximal steering", self.max_steering, "at most 1.4"));
        }
        Ok(())
    }
}

/// What a car is told.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Command {
    pub(super) speed: f64,
    pub(super) steering: f64,
}

/// Where a car is and how it moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Body {
    /// The centre of mass.
    x: f64,
    y: f64,
    heading: f64,
    /// Speed along the car and to its left, at the centre of mass.
    along: f64,
    across: f64,
    yaw_rate: f64,
    pub(super) steering: f64,
}

/// Below the first speed the wheels roll, above the second one they slip; between, it is a mixture.
const ROLLS: f64 = 2.0;
const SLIPS: f64 = 4.0;
const GRAVITY: f64 = 9.81;

impl Body {
    /// A car that stands with the middle of its rear axle at a pose.
    pub(super) fn standing(spec: &RaceCarSpec, pose: Pose) -> Self {
        let centre = pose.to_world(Point::new(spec.rear, 0.0));
        Self {
            x: centre.x,
            y: centre.y,
            heading: pose.heading,
            along: 0.0,
            across: 0.0,
            yaw_rate: 0.0,
            steering: 0.0,
        }
    }

    /// The pose of the middle of the rear axle.
    pub(super) fn pose(&self, spec: &RaceCarSpec) -> Pose {
        let rear = Pose::new(self.x, self.y, self.heading).to_world(Point::new(-spec.rear, 0.0));
        Pose::new(rear.x, rear.y, self.heading)
    }

    /// Speed along the car, and the rate of its heading.
    pub(super) fn twist(&self) -> Twist {
        Twist::new(self.along, self.yaw_rate)
    }

    /// Metres per second of the centre of mass, whichever way.
    pub(super) fn speed(&self) -> f64 {
        math::hypot(self.along, self.across)
    }

    /// Metres per second to the left, at the rear axle.
    pub(super) fn slip(&self, spec: &RaceCarSpec) -> f64 {
        self.across - spec.rear * self.yaw_rate
    }

    /// Lets a command act for some seconds, in one step of at most 2 ms or so.
    pub(super) fn step(&mut self, spec: &RaceCarSpec, command: Command, dt: f64) {
        let most = spec.steering_rate * dt;
        let wanted = command.steering.clamp(-spec.max_steering, spec.max_steering);
        self.steering += (wanted - self.steering).clamp(-most, most);
        let speed = command.speed.clamp(-spec.top_speed, spec.top_speed);
        let wish = (speed - self.along) * spec.speed_gain;
        // Towards standing it brakes, away from it it drives.
        let slows = wish * self.along < 0.0;
        let limit = if slows { spec.brake } else { spec.drive };
        let push = wish.clamp(-limit, limit).clamp(-spec.grip, spec.grip);
        let (sin, cos) = math::sin_cos(self.heading);
        let share = match spec.model {
            CarModel::Kinematic => 0.0,
            CarModel::Dynamic => {
                let fastest = math::hypot(self.along, self.slip(spec));
                ((fastest - ROLLS) / (SLIPS - ROLLS)).clamp(0.0, 1.0)
            }
        };
        let mut next = *self;
        if share > 0.0 {
            next.slide(spec, push, dt);
        }
        if share < 1.0 {
            let curvature = math::tan(self.steering) / spec.wheelbase();
            let along = self.along + push * dt;
            // It does not brake beyond standing.
            let along = if slows && along * self.along < 0.0 { 0.0 } else { along };
            let yaw_rate = along * curvature;
            let mix = |slides: f64, rolls: f64| share * slides + (1.0 - share) * rolls;
            next.along = mix(next.along, along);
            next.yaw_rate = mix(next.yaw_rate, yaw_rate);
            next.across = mix(next.across, yaw_rate * spec.rear);
            if spec.model == CarModel::Dynamic {
                next.hold(self, spec, dt);
            }
        }
        next.x += dt * (cos * next.along - sin * next.across);
        next.y += dt * (sin * next.along + cos * next.across);
        next.heading = crate::geometry::normalize_angle(self.heading + dt * next.yaw_rate);
        *self = next;
    }

    /// Keeps what has changed since before within what the tyres can hold: wheels that roll do not begin to at once.
    fn hold(&mut self, before: &Self, spec: &RaceCarSpec, dt: f64) {
        let turned = |rate: f64, along: f64, across: f64| {
            let (sin, cos) = math::sin_cos(dt * rate);
            (cos * along - sin * across, sin * along + cos * across)
        };
        let (along, across) = turned(self.yaw_rate, self.along, self.across);
        let change = (along - before.along, across - before.across);
        let excess = math::hypot(change.0, change.1) / (spec.grip * dt);
        // Rounding is none.
        if excess <= 1.001 {
            return;
        }
        self.yaw_rate = before.yaw_rate + (self.yaw_rate - before.yaw_rate) / excess;
        let (along, across) = (before.along + change.0 / excess, before.across + change.1 / excess);
        (self.along, self.across) = turned(-self.yaw_rate, along, across);
    }

    /// The forces of the tyres act on the speeds.
    fn slide(&mut self, spec: &RaceCarSpec, push: f64, dt: f64) {
        let base = spec.wheelbase();
        let v = self.along.abs().max(0.5);
        // Backwards a wheel that is turned leads to the other side.
        let steered = self.steering * (self.along / 0.5).clamp(-1.0, 1.0);
        let slips = [
            math::atan2(self.across + spec.front * self.yaw_rate, v) - steered,
            math::atan2(self.across - spec.rear * self.yaw_rate, v),
        ];
        // Without transfer of load, each axle carries what the levers give it, and drives in proportion.
        let loads = [spec.rear / base, spec.front / base];
        let [front, rear] = [0, 1].map(|axle| {
            let (along, circle) = (push * loads[axle], spec.grip * loads[axle]);
            let share = if axle == 0 { spec.balance } else { 1.0 };
            let across = share * (circle * circle - along * along).max(1e-6).sqrt();
            let linear = -share * spec.stiffness * GRAVITY * loads[axle] * slips[axle];
            let ratio = linear / across;
            (along, linear / (1.0 + ratio * ratio).sqrt())
        });
        let (sin, cos) = math::sin_cos(self.steering);
        let along = front.0 * cos - front.1 * sin + rear.0;
        let across = front.0 * sin + front.1 * cos + rear.1;
        let turn = spec.front * (front.0 * sin + front.1 * cos) - spec.rear * rear.1;
        self.yaw_rate += dt * turn / (spec.gyration * spec.gyration);
        // The frame turns under the velocity.
        let (sin, cos) = math::sin_cos(dt * self.yaw_rate);
        let (x, y) = (self.along + dt * along, self.across + dt * across);
        self.along = cos * x + sin * y;
        self.across = cos * y - sin * x;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settle(model: CarModel, speed: f64, steering: f64, seconds: f64) -> (RaceCarSpec, Body) {
        let spec = RaceCarSpec { model, ..RaceCarSpec::default() };
        let mut body = Body::standing(&spec, Pose::default());
        for _ in 0..(seconds * 500.0) as usize {
            body.step(&spec, Command { speed, steering }, 0.002);
        }
        (spec, body)
    }

    #[test]
    fn slow_cars_roll_in_circles() {
        for model in [CarModel::Kinematic, CarModel::Dynamic] {
            let (spec, body) = settle(model, 1.5, 0.3, 5.0);
            let curvature = body.yaw_rate / body.along;
            assert!((curvature - math::tan(0.3) / spec.wheelbase()).abs() < 1e-6);
            assert!(body.slip(&spec).abs() < 1e-9);
        }
    }

    /// The acceleration of the centre of mass between two steps, in the frame of the world.
    fn acceleration(before: &Body, after: &Body, dt: f64) -> f64 {
        let velocity = |b: &Body| {
            let (sin, cos) = math::sin_cos(b.heading);
            (cos * b.along - sin * b.across, sin * b.along + cos * b.across)
        };
        let ((a, b), (c, d)) = (velocity(before), velocity(after));
        math::hypot(c - a, d - b) / dt
    }

    #[test]
    fn no_force_leaves_the_friction_circle() {
        for (speed, steering) in
            [(8.0, 0.1), (12.0, 0.2), (20.0, 0.4), (25.0, 0.05), (-25.0, 0.2), (-6.0, 0.6)]
        {
            let spec = RaceCarSpec::default();
            let mut body = Body::standing(&spec, Pose::default());
            for _ in 0..4000 {
                let (before, dt) = (body, 0.002);
                body.step(&spec, Command { speed, steering }, dt);
                let acceleration = acceleration(&before, &body, dt);
                assert!(acceleration < 1.02 * spec.grip, "{acceleration} at {before:?}");
            }
        }
    }

    /// However it moves and whatever it is told, sliding sideways and backwards included, and the sliding comes to an end.
    #[test]
    fn nor_does_any_from_random_driving() {
        let (spec, mut random) = (RaceCarSpec::default(), crate::random::Stream::new(11));
        for _ in 0..300 {
            let mut body = Body::standing(&spec, Pose::default());
            (body.along, body.across) = (random.between(-25.0, 25.0), random.between(-12.0, 12.0));
            (body.yaw_rate, body.steering) = (random.between(-5.0, 5.0), random.between(-0.6, 0.6));
            for k in 0..3000 {
                let wish = if k < 1000 { random.between(-30.0, 30.0) } else { 0.0 };
                let command = Command { speed: wish, steering: random.between(-0.6, 0.6) };
                let (before, dt) = (body, 0.002);
                body.step(&spec, command, dt);
                let acceleration = acceleration(&before, &body, dt);
                assert!(acceleration < 1.02 * spec.grip, "{acceleration} at {before:?}");
            }
            assert!(math::hypot(body.along, body.across) < 1e-2, "it stands: {body:?}");
        }
    }

    #[test]
    fn no_steering_gives_more_across_than_the_balance() {
        let bound = RaceCarSpec::default().cornering();
        for curvature in [0.03, 0.08, 0.15, 0.25] {
            // Of all circles that the car comes to drive at some speeds, those of about that curvature.
            let mut best = 0.0_f64;
            for steering in 1..30 {
                for speed in 1..20 {
                    let speed = (0.06 * f64::from(speed) * bound / curvature).sqrt();
                    let (spec, body) = settle(CarModel::Dynamic, speed, 0.02 * f64::from(steering), 6.0);
                    let velocity = math::hypot(body.along, body.across);
                    if (body.yaw_rate / velocity / curvature - 1.0).abs() < 0.03 && body.along > SLIPS {
                        best = best.max(body.yaw_rate * velocity);
                    }
                    assert!(body.slip(&spec).is_finite());
                }
            }
            assert!(best < 1.02 * bound && best > 0.85 * bound, "{curvature}: {best} of {bound}");
        }
    }

    #[test]
    fn brakes_bring_it_to_stand_within_the_distance() {
        let (spec, mut body) = settle(CarModel::Dynamic, 20.0, 0.0, 6.0);
        assert!((body.along - 20.0).abs() < 0.01);
        let from = body.x;
        for _ in 0..3000 {
            body.step(&spec, Command::default(), 0.002);
        }
        let way = body.x - from;
        // v²/2a, and v/gain for the end that it brakes softly.
        let bound = 20.0 * 20.0 / (2.0 * spec.brake) + 20.0 / spec.speed_gain;
        assert!(body.along.abs() < 1e-3 && way < bound && way > 15.0, "{way} of {bound}");
    }

    #[test]
    fn it_drives_backwards_as_well() {
        let (_, body) = settle(CarModel::Dynamic, -1.0, 0.2, 3.0);
        assert!((body.along + 1.0).abs() < 1e-6 && body.yaw_rate < 0.0);
    }

    #[test]
    fn numbers_that_are_no_car() {
        let error = RaceCarSpec { grip: f64::NAN, ..RaceCarSpec::default() }.validate().unwrap_err();
        assert_eq!(error.to_string(), "grip is NaN; expected more than 0 and less than 1000");
    }
}
