//! Runs the two craft of Fossen's Python Vehicle Simulator under that program's autopilots, so that
//! `tests/interop/craft.py` can hold the runs against it.
//!
//! `craft remus100|otter euler|own STEP STEPS SPEED DIRECTION` prints a line for each step: position, roll,
//! pitch and yaw with x forward, y right and z down. `euler` integrates as that program does, and takes the
//! current as it does: turned by the yaw alone. `own` is the library's integrator, in water without a
//! current.

use roverlab::geometry::{Point3, Pose3, Vector3, angle_difference, math};
use roverlab::kinematics::marine::{CraftMotion, CraftState, LocalWater, Otter, Remus100, Wrench};

/// Position and Euler angles, and speeds, with y right and z down.
#[derive(Clone, Copy)]
struct State {
    place: [f64; 6],
    speed: [f64; 6],
}

/// What a vehicle of the program does in a step.
trait Vehicle {
    /// The commands of its autopilot.
    fn commands(&mut self, state: &State, step: f64) -> [f64; 3];
    /// The acceleration through the water by its actuators as they are, at speeds through the water and over
    /// ground.
    fn response(&self, state: &State, through_water: &CraftMotion) -> CraftMotion;
    /// Lets the actuators follow as the program does.
    fn follow(&mut self, commands: [f64; 3], step: f64);
    /// Moves by a step of the library's integrator.
    fn advance(&mut self, state: &mut CraftState, commands: [f64; 3], step: f64);
    /// The frame's own start.
    fn start(&self) -> CraftState;
}

fn over(vector: Vector3) -> Vector3 {
    Vector3::new(vector.x, -vector.y, -vector.z)
}

fn motion(speed: &[f64; 6]) -> CraftMotion {
    CraftMotion {
        linear: over(Vector3::new(speed[0], speed[1], speed[2])),
        angular: over(Vector3::new(speed[3], speed[4], speed[5])),
    }
}

impl State {
    fn of(state: &CraftState) -> Self {
        let pose = Pose3::new(state.position, state.attitude);
        let [roll, pitch, yaw] = pose.roll_pitch_yaw();
        let (place, linear, angular) =
            (over(state.position.coords), over(state.velocity.linear), over(state.velocity.angular));
        Self {
            place: [place.x, place.y, place.z, roll, -pitch, -yaw],
            speed: [linear.x, linear.y, linear.z, angular.x, angular.y, angular.z],
        }
    }

    /// A step of the program's integrator: speeds first, then Euler angles by the new speeds.
    fn euler(&mut self, vehicle: &dyn Vehicle, (speed, direction): (f64, f64), step: f64) {
        let (sin, cos) = math::sin_cos(direction - self.place[5]);
        let (ahead, right) = (speed * cos, speed * sin);
        let mut relative = self.speed;
        (relative[0], relative[1]) = (relative[0] - ahead, relative[1] - right);
        let response = vehicle.response(self, &motion(&relative));
        let (linear, angular) = (over(response.linear), over(response.angular));
        let turned = [self.speed[5] * right, -self.speed[5] * ahead];
        let rates = [linear.x + turned[0], linear.y + turned[1], linear.z, angular.x, angular.y, angular.z];
        for (speed, rate) in self.speed.iter_mut().zip(rates) {
            *speed += step * rate;
        }
        let [_, _, _, roll, pitch, yaw] = self.place;
        let [(sr, cr), (sp, cp), (sy, cy)] = [roll, pitch, yaw].map(math::sin_cos);
        let [u, v, w, p, q, r] = self.speed;
        let rates = [
            cy * cp * u + (cy * sp * sr - sy * cr) * v + (sy * sr + cy * cr * sp) * w,
            sy * cp * u + (cy * cr + sr * sp * sy) * v + (sp * sy * cr - cy * sr) * w,
            -sp * u + cp * sr * v + cp * cr * w,
            p + (sr * q + cr * r) * sp / cp,
            cr * q - sr * r,
            (sr * q + cr * r) / cp,
        ];
        for (place, rate) in self.place.iter_mut().zip(rates) {
            *place += step * rate;
        }
    }
}

/// The third-order model through which both autopilots smooth the heading that they are given.
#[derive(Default)]
struct Reference {
    angle: f64,
    rate: f64,
    acceleration: f64,
}

impl Reference {
    fn step(&mut self, goal: f64, frequency: f64, fastest: f64, step: f64) {
        let square = frequency * frequency;
        let jerk = square * frequency * (goal - self.angle)
            - 3.0 * square * self.rate
            - 3.0 * frequency * self.acceleration;
        self.angle += step * self.rate;
        self.rate += step * self.acceleration;
        self.acceleration += step * jerk;
        self.rate = self.rate.clamp(-fastest, fastest);
    }
}

struct Remus {
    vehicle: Remus100,
    /// Rudder, stern planes, and propeller in rpm.
    actual: [f64; 3],
    heading: Reference,
    heading_sum: f64,
    depth: f64,
    depth_sum: f64,
    pitch_sum: f64,
}

const DEGREE: f64 = std::f64::consts::PI / 180.0;

impl Remus {
    fn limited(&self) -> [f64; 3] {
        let most = 15.0 * DEGREE;
        let [rudder, stern, rpm] = self.actual;
        [rudder.clamp(-most, most), stern.clamp(-most, most), rpm.clamp(-1525.0, 1525.0)]
    }

    fn controls([rudder, stern, rpm]: [f64; 3]) -> [f64; 3] {
        [rudder, stern, rpm / 60.0]
    }
}

impl Vehicle for Remus {
    fn commands(&mut self, state: &State, step: f64) -> [f64; 3] {
        let [_, _, depth, _, pitch, yaw] = state.place;
        let [_, _, heave, _, pitching, turning] = state.speed;
        let (goal, heading) = (30.0, 50.0 * DEGREE);
        let left = math::exp(-0.02 * step);
        self.depth = left * self.depth + (1.0 - left) * goal;
        let wished = 0.1 * ((depth - self.depth) + self.depth_sum / 100.0);
        let off = angle_difference(pitch, wished);
        let stern = -5.0 * off - 2.0 * pitching - 0.3 * self.pitch_sum - 5.0 * heave;
        self.depth_sum += step * (depth - self.depth);
        self.pitch_sum += step * off;
        let (off, slip) = (angle_difference(yaw, self.heading.angle), turning - self.heading.rate);
        let (lambda, layer) = (0.1, 0.1);
        let slope = self.heading.acceleration - 2.0 * lambda * slip - lambda * lambda * off;
        let rate = self.heading.rate - 2.0 * lambda * off - lambda * lambda * self.heading_sum;
        let surface = slip + 2.0 * lambda * off + lambda * lambda * self.heading_sum;
        let switching = (surface / layer).clamp(-1.0, 1.0);
        let rudder = (slope + rate - 0.5 * surface - 0.05 * switching) / 0.25;
        self.heading_sum += step * off;
        self.heading.step(heading, 0.1, 5.0 * DEGREE, step);
        [rudder, -stern, 1525.0]
    }

    fn response(&self, state: &State, through_water: &CraftMotion) -> CraftMotion {
        let [u, v, w, ..] = state.speed;
        let speed = Vector3::new(u, v, w).norm();
        let forces = self.vehicle.forces(through_water, speed, Self::controls(self.limited()));
        let [_, _, _, roll, pitch, yaw] = state.place;
        let pose = Pose3::from_angles(Point3::new(0.0, 0.0, -100.0), roll, -pitch, -yaw);
        let craft = &self.vehicle.craft;
        let restoring = craft.restoring(&CraftState::at_rest(craft, &pose), &sea());
        craft.response(through_water, &(forces + restoring))
    }

    fn follow(&mut self, commands: [f64; 3], step: f64) {
        let limited = self.limited();
        for (number, lag) in [0.1, 0.1, 1.0].into_iter().enumerate() {
            self.actual[number] = limited[number] + step * (commands[number] - limited[number]) / lag;
        }
    }

    fn advance(&mut self, state: &mut CraftState, commands: [f64; 3], step: f64) {
        let controls = Self::controls(self.limited());
        let vehicle = &self.vehicle;
        vehicle.craft.advance_under(state, &[], &sea(), |at| {
            vehicle.forces(&at.velocity, at.velocity.linear.norm(), controls)
        });
        let limited = self.limited();
        for (number, lag) in [0.1, 0.1, 1.0].into_iter().enumerate() {
            let left = math::exp(-step / lag);
            self.actual[number] = commands[number] + (limited[number] - commands[number]) * left;
        }
    }

    fn start(&self) -> CraftState {
        CraftState::at_rest(&self.vehicle.craft, &Pose3::default())
    }
}

/// So deep that the craft, which the program lets begin at depth 0, is under water.
fn sea() -> LocalWater {
    LocalWater { density: 1026.0, ..LocalWater::still(100.0) }
}

struct Catamaran {
    vehicle: Otter,
    /// Speeds of the propellers in rad/s.
    actual: [f64; 2],
    heading: Reference,
    heading_sum: f64,
}

impl Catamaran {
    fn limited(&self) -> [f64; 2] {
        let least = -(0.5 * 13.6 * 9.81 / Otter::THRUST[1]).sqrt();
        self.actual.map(|speed| speed.clamp(least, Otter::full_speed()))
    }
}

impl Vehicle for Catamaran {
    fn commands(&mut self, state: &State, step: f64) -> [f64; 3] {
        let (off, slip) = (state.place[5] - self.heading.angle, state.speed[5] - self.heading.rate);
        let (inertia, frequency) = (41.4, 2.5);
        let stiffness = inertia * frequency * frequency;
        let damping = 2.0 * inertia * frequency - inertia;
        let moment = -stiffness * off - damping * slip - 0.1 * frequency * stiffness * self.heading_sum;
        self.heading_sum += step * off;
        self.heading.step(100.0 * DEGREE, 0.5, 10.0 * DEGREE, step);
        let [gain, lever] = [Otter::THRUST[0], 0.395];
        let squares = [0.5 * (200.0 + moment / lever) / gain, 0.5 * (200.0 - moment / lever) / gain];
        let [left, right] = squares.map(|square: f64| square.signum() * square.abs().sqrt());
        [left, right, 0.0]
    }

    fn response(&self, state: &State, through_water: &CraftMotion) -> CraftMotion {
        let thrust = self.limited().map(|speed| {
            let gain = if speed > 0.0 { Otter::THRUST[0] } else { Otter::THRUST[1] };
            gain * speed * speed.abs()
        });
        let turning = Vector3::z() * (0.395 * (thrust[1] - thrust[0]));
        let propellers = Wrench { force: Vector3::x() * (thrust[0] + thrust[1]), moment: turning };
        let [_, _, depth, roll, pitch, _] = state.place;
        let forces = self.vehicle.forces(through_water, -depth, [roll, -pitch]);
        self.vehicle.craft.response(through_water, &(forces + propellers))
    }

    fn follow(&mut self, commands: [f64; 3], step: f64) {
        let limited = self.limited();
        for (number, actual) in self.actual.iter_mut().enumerate() {
            *actual = limited[number] + step * (commands[number] - limited[number]) / 0.1;
        }
    }

    fn advance(&mut self, state: &mut CraftState, commands: [f64; 3], _step: f64) {
        let shares = [commands[0], commands[1]].map(|speed| speed / Otter::full_speed());
        let vehicle = &self.vehicle;
        vehicle.craft.advance_under(state, &shares, &LocalWater::still(100.0), |at| {
            let [roll, pitch, _] = Pose3::new(at.position, at.attitude).roll_pitch_yaw();
            vehicle.forces(&at.velocity, at.position.z, [roll, pitch])
        });
    }

    fn start(&self) -> CraftState {
        CraftState::at_rest(&self.vehicle.craft, &Pose3::default())
    }
}

fn vehicle(name: &str, step: f64) -> Option<Box<dyn Vehicle>> {
    match name {
        "remus100" => Some(Box::new(Remus {
            vehicle: Remus100::new(step).ok()?,
            actual: [0.0; 3],
            heading: Reference::default(),
            heading_sum: 0.0,
            depth: 0.0,
            depth_sum: 0.0,
            pitch_sum: 0.0,
        })),
        "otter" => Some(Box::new(Catamaran {
            vehicle: Otter::new(step).ok()?,
            actual: [0.0; 2],
            heading: Reference::default(),
            heading_sum: 0.0,
        })),
        _ => None,
    }
}

fn run(arguments: &[String]) -> Option<String> {
    use std::fmt::Write as _;
    let [name, integrator, numbers @ ..] = arguments else { return None };
    let numbers: Vec<f64> = numbers.iter().map(|number| number.parse().ok()).collect::<Option<_>>()?;
    let [step, steps, speed, direction] = numbers[..] else { return None };
    let mut vehicle = vehicle(name, step)?;
    let mut own = vehicle.start();
    let mut state = State::of(&own);
    let mut text = String::new();
    for _ in 0..=steps as u32 {
        writeln!(text, "{}", state.place.map(|number| format!("{number:.17e}")).join(" ")).ok()?;
        let commands = vehicle.commands(&state, step);
        if integrator == "own" {
            vehicle.advance(&mut own, commands, step);
            state = State::of(&own);
        } else {
            state.euler(vehicle.as_ref(), (speed, direction * DEGREE), step);
            vehicle.follow(commands, step);
        }
    }
    Some(text)
}

fn main() -> std::process::ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let Some(text) = run(&arguments) {
        print!("{text}");
        return std::process::ExitCode::SUCCESS;
    }
    eprintln!("usage: craft remus100|otter euler|own STEP STEPS SPEED DIRECTION");
    std::process::ExitCode::FAILURE
}
