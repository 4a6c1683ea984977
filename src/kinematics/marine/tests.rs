use super::*;
use crate::geometry::{Point3, Pose3, Vector3, math};
use crate::random::Stream;

fn mako() -> Craft {
    Craft::new(&CraftSpec::mako(), 0.01).unwrap()
}

fn floating(craft: &Craft, height: f64) -> CraftState {
    CraftState::at_rest(craft, &Pose3::from_angles(Point3::new(0.0, 0.0, height), 0.0, 0.0, 0.0))
}

fn run(craft: &Craft, state: &mut CraftState, commands: &[f64], water: &LocalWater, seconds: f64) {
    for _ in 0..(seconds / craft.step()) as u32 {
        craft.advance(state, commands, water);
    }
}

fn near(found: f64, expected: f64) {
    assert!((found / expected - 1.0).abs() < 1e-3, "{found}, expected {expected}");
}

/// The speed at which linear and quadratic damping balance a force.
fn terminal(linear: f64, quadratic: f64, force: f64) -> f64 {
    ((linear * linear + 4.0 * quadratic * force).sqrt() - linear) / (2.0 * quadratic)
}

#[test]
fn speeds_come_to_where_damping_equals_the_force() {
    let (spec, craft) = (CraftSpec::mako(), mako());
    let deep = LocalWater::still(100.0);
    let mut state = floating(&craft, 0.0);
    run(&craft, &mut state, &[], &deep, 40.0);
    let rise = state.attitude * state.velocity.linear;
    near(rise.z, terminal(spec.linear_damping[2], spec.quadratic_damping[2], craft.reserve(1000.0)));
    // Neutral buoyancy, and thrusters at the height of the centre of mass: thrust causes no pitch.
    let mut hovering = spec.clone();
    hovering.mass = 1000.0 * hovering.hull.iter().map(HullPart::volume).sum::<f64>();
    hovering.thrusters.iter_mut().for_each(|thruster| thruster.place.z = 0.0);
    let middle = Craft::new(&hovering, 0.01).unwrap().middle();
    hovering.centre_of_mass = middle;
    hovering.thrusters.iter_mut().for_each(|thruster| thruster.place.z = middle.z);
    let craft = Craft::new(&hovering, 0.01).unwrap();
    for (commands, force) in [([1.0, 0.0, 1.0, 0.0], 50.0), ([-1.0, 0.0, -1.0, 0.0], -35.0)] {
        let mut state = floating(&craft, 0.0);
        run(&craft, &mut state, &commands, &deep, 60.0);
        let speed = terminal(spec.linear_damping[0], spec.quadratic_damping[0], f64::abs(force));
        near(state.velocity.linear.x, speed.copysign(force));
    }
}

#[test]
fn a_current_carries_what_drifts() {
    let craft = mako();
    let water = LocalWater { velocity: Vector3::new(0.3, -0.2, 0.0), ..LocalWater::still(100.0) };
    let mut state = floating(&craft, 0.0);
    run(&craft, &mut state, &[], &water, 150.0);
    let drift = state.attitude * state.velocity.linear;
    near(drift.x, 0.3);
    near(drift.y, -0.2);
}

#[test]
fn draught_and_heel_are_those_of_archimedes() {
    let raft = Craft::new(&CraftSpec::solar_raft(), 0.01).unwrap();
    let still = LocalWater::still(0.0);
    let mut state = floating(&raft, -0.05);
    run(&raft, &mut state, &[], &still, 200.0);
    near(raft.displaced(&state, &still).volume, 0.020);
    // Heel is moment over weight times metacentric height.
    let upright = state;
    let moment = 0.5;
    for _ in 0..20_000 {
        raft.advance_under(&mut state, &[], &still, |_| Wrench {
            moment: Vector3::x() * moment,
            ..Wrench::NONE
        });
    }
    let displaced = raft.displaced(&upright, &still);
    let volume = |level: f64| {
        let mut lower = upright;
        lower.position.z -= level;
        raft.displaced(&lower, &still).volume
    };
    let plane = (volume(1e-4) - volume(-1e-4)) / 2e-4;
    // The waterplane is two strips, 0.3 m to each side.
    let length = plane / (2.0 * (plane / 2.6).min(0.16));
    let width = plane / (2.0 * length);
    let inertia = 2.0 * (length * width * width * width / 12.0 + length * width * 0.09);
    let metacentric = displaced.centre().z + inertia / displaced.volume - raft.mass_centre.z;
    let [heel, _, _] = state.pose(&raft).roll_pitch_yaw();
    assert!(
        (heel / (moment / (raft.mass * GRAVITY * metacentric)) - 1.0).abs() < 0.02,
        "{heel} {metacentric}"
    );
}

#[test]
fn heave_and_roll_have_the_periods_of_their_springs() {
    // An undamped box, half immersed: closed forms exist.
    let (length, width, height) = (1.0, 0.6, 0.4);
    let block = HullPart::Box { size: Vector3::new(length, width, height), centre: Point3::origin() };
    let mut spec = CraftSpec::of_hull(120.0, Point3::new(0.0, 0.0, -0.05), vec![block]);
    (spec.linear_damping, spec.quadratic_damping) = ([0.0; 6], [0.0; 6]);
    // Let it roll about its centre of mass.
    spec.added_mass[1] = 0.0;
    let craft = Craft::new(&spec, 0.005).unwrap();
    let still = LocalWater::still(0.0);
    let tau = std::f64::consts::TAU;
    let heave = (1000.0 * GRAVITY * length * width / (spec.mass + spec.added_mass[2])).sqrt();
    let mut state = floating(&craft, 0.01);
    near(period(&craft, &mut state, |state| state.position.z), tau / heave);
    // Metacentric height: the centre of buoyancy is 0.1 m below the surface.
    let metacentric = -0.1 + length * width * width * width / 12.0 / 0.12 + 0.05;
    let inertia = spec.inertia[0][0] + spec.added_mass[3];
    let roll = (spec.mass * GRAVITY * metacentric / inertia).sqrt();
    let mut state = CraftState::at_rest(&craft, &Pose3::from_angles(Point3::origin(), 0.004, 0.0, 0.0));
    near(period(&craft, &mut state, |state| (state.attitude * Vector3::y()).z), tau / roll);
    assert!((craft.energy(&state, &still) - craft.energy(&floating(&craft, 0.0), &still)).abs() < 0.02);
}

/// Mean period of ten oscillations about 0.
fn period(craft: &Craft, state: &mut CraftState, of: impl Fn(&CraftState) -> f64) -> f64 {
    let (mut crossings, mut first, mut last) = (0, 0.0, 0.0);
    let mut before = of(state);
    for step in 1..100_000 {
        craft.advance(state, &[], &LocalWater::still(0.0));
        let now = of(state);
        if before < 0.0 && now >= 0.0 {
            last = (f64::from(step) - now / (now - before)) * craft.step();
            if crossings == 0 {
                first = last;
            }
            crossings += 1;
            if crossings == 11 {
                break;
            }
        }
        before = now;
    }
    (last - first) / 10.0
}

/// Energy never rises, from random poses and velocities, half of them at the surface.
fn energy_falls(starts: u32, seconds: f64, seed: u64) {
    let mut stream = Stream::new(seed);
    let crafts = [CraftSpec::mako(), CraftSpec::solar_raft()].map(|spec| Craft::new(&spec, 0.01).unwrap());
    for start in 0..starts {
        let craft = &crafts[(start / 2 % 2) as usize];
        let mut angle = || stream.between(-std::f64::consts::PI, std::f64::consts::PI);
        let (roll, pitch, yaw) = (angle(), 0.5 * angle(), angle());
        let depth = if start % 2 == 0 { stream.between(-0.4, 0.4) } else { -20.0 };
        let pose = Pose3::from_angles(Point3::new(0.0, 0.0, depth), roll, pitch, yaw);
        let mut state = CraftState::at_rest(craft, &pose);
        let mut draw = |most: f64| Vector3::from_fn(|_, _| stream.between(-most, most));
        state.velocity = CraftMotion { linear: draw(1.5), angular: draw(2.0) };
        let still = LocalWater::still(0.0);
        let mut before = craft.energy(&state, &still);
        for step in 0..(seconds / craft.step()) as u32 {
            craft.advance(&mut state, &[], &still);
            let after = craft.energy(&state, &still);
            assert!(
                after <= before + 1e-6 * (1.0 + before.abs()),
                "start {start}, step {step}: {before} to {after}"
            );
            before = after;
        }
        assert!(state.is_finite());
    }
}

#[test]
fn energy_never_rises_by_itself() {
    energy_falls(60, 10.0, 1);
}

#[test]
fn thrusters_lag_are_weaker_backwards_and_draw_air() {
    let craft = mako();
    let mut state = floating(&craft, -5.0);
    run(&craft, &mut state, &[1.0, 0.0, -1.0, 0.0], &LocalWater::still(0.0), 0.2);
    assert!((state.shafts[0] - (1.0 - math::exp(-1.0))).abs() < 1e-9, "{:?}", state.shafts);
    assert!(
        state.velocity.angular.z < 0.0 && state.velocity.linear.x > 0.0,
        "left forward turns right and ahead"
    );
    // In air there is no thrust.
    let mut state = floating(&craft, 5.0);
    run(&craft, &mut state, &[1.0, 0.0, 1.0, 0.0], &LocalWater::still(0.0), 0.2);
    assert_eq!(state.velocity.linear.x, 0.0);
    assert!((state.velocity.linear.z / (-GRAVITY * 0.2) - 1.0).abs() < 0.7, "{:?}", state.velocity);
}

#[test]
fn half_the_step_is_a_sixteenth_of_the_error() {
    let end = |step: f64| {
        let craft = Craft::new(&CraftSpec::mako(), step).unwrap();
        let mut state =
            CraftState::at_rest(&craft, &Pose3::from_angles(Point3::new(0.0, 0.0, -9.0), 0.3, 0.4, 0.1));
        state.velocity =
            CraftMotion { linear: Vector3::new(1.0, 0.4, -0.3), angular: Vector3::new(0.5, 0.2, 0.4) };
        run(&craft, &mut state, &[], &LocalWater::still(0.0), 2.0);
        state.position
    };
    let best = end(0.00125);
    let (coarse, fine) = ((end(0.04) - best).norm(), (end(0.02) - best).norm());
    assert!(coarse / fine > 8.0 && fine < 1e-5, "{coarse} {fine}");
}

#[test]
fn nonsense_is_refused_by_name() {
    let refused = |change: &dyn Fn(&mut CraftSpec)| {
        let mut spec = CraftSpec::mako();
        change(&mut spec);
        Craft::new(&spec, 0.01).map(|_| ()).unwrap_err().name().to_owned()
    };
    assert_eq!(refused(&|spec| spec.mass = -1.0), "craft's mass");
    assert_eq!(refused(&|spec| spec.inertia[1][1] = -3.0), "craft's least principal moment of inertia");
    assert_eq!(refused(&|spec| spec.added_mass[2] = f64::NAN), "added mass");
    assert_eq!(
        refused(&|spec| spec.thrusters[0].direction = Vector3::zeros()),
        "length of a thruster's direction"
    );
    assert_eq!(refused(&|spec| spec.thrusters[0].back = 99.0), "thruster's force backward");
    let negative = HullPart::Box { size: Vector3::new(1.0, -1.0, 1.0), centre: Point3::origin() };
    assert_eq!(refused(&|spec| spec.hull = vec![negative]), "hull part's size");
    assert!(
        Craft::new(&CraftSpec::mako(), f64::NAN).is_err() && Craft::new(&CraftSpec::mako(), 1.0).is_err()
    );
}

mod campaigns {
    #[test]
    #[ignore = "takes minutes: cargo test --release --lib -- --ignored energy_never_rises"]
    fn energy_never_rises_from_100_000_starts() {
        super::energy_falls(100_000, 10.0, 7);
    }
}
