use super::*;
use crate::kinematics::{Displacement, advance};
use proptest::prelude::*;

/// A robot that does exactly as it is told. Returns where it ends, and its steps.
fn drive(method: Method, goal: Goal, start: Pose) -> (Pose, u32) {
    let mut behaviour = AToB::new(method, goal, AToBParameters::default()).unwrap();
    let mut pose = start;
    for step in 0..20_000 {
        let motion = match behaviour.step(&AToBObservation { pose, done: true, stalled: false }).unwrap() {
            Some(Manoeuvre::Speed(twist)) => {
                Displacement { length: 0.02 * twist.linear, angle: 0.02 * twist.angular }
            }
            Some(Manoeuvre::Straight(length, _)) => Displacement { length, angle: 0.0 },
            Some(Manoeuvre::Turn(angle, _)) => Displacement { length: 0.0, angle },
            Some(Manoeuvre::Continue) => unreachable!("the manoeuvre is done"),
            None => return (pose, step),
        };
        pose = advance(pose, motion);
    }
    panic!("{method:?} from {start:?} to {goal:?} has no end; now at {pose:?}");
}

proptest! {
    #![proptest_config(crate::testing::cases(100))]
    #[test]
    fn every_method_arrives(
        x in -2.0..2.0f64, y in -2.0..2.0f64, heading in -3.0..3.0f64, at in -3.0..3.0f64, posed: bool,
    ) {
        let (start, place) = (Pose::new(0.2, -0.1, heading), Point::new(x, y));
        arrives(start, Goal { position: place, heading: posed.then_some(at) })?;
    }
}

/// Drives to a goal by every method.
fn arrives(start: Pose, goal: Goal) -> std::result::Result<(), TestCaseError> {
    for method in [Method::Turn, Method::Arc, Method::Dog, Method::Spline] {
        let (end, _) = drive(method, goal, start);
        prop_assert!(end.distance_to(goal.position) < 1e-3, "{method:?}: {end:?}");
        if let Some(heading) = goal.heading {
            prop_assert!(angle_difference(end.heading, heading).abs() < 2e-3, "{method:?}: {end:?}");
        }
    }
    Ok(())
}

#[test]
fn a_near_goal_that_faces_back_is_arrived_at() {
    let goal =
        Goal::pose(Pose::new(-0.548_393_080_125_799_2, 0.027_724_735_621_608_75, 0.064_106_612_949_614_16));
    arrives(Pose::new(0.2, -0.1, 2.354_172_279_733_370_4), goal).unwrap();
}

#[test]
fn waypoints_are_passed_on_the_way_and_only_by_splines() {
    let (goal, via) = (Goal::pose(Pose::new(2.0, 0.0, 0.5)), [(0.6, 0.5), (1.3, -0.4)]);
    let via = via.map(|(x, y)| Point::new(x, y));
    let drive = |method| AToB::new(method, goal, AToBParameters::default()).unwrap();
    let mut behaviour = drive(Method::Spline).via(via.to_vec()).unwrap();
    let (mut pose, mut least) = (Pose::default(), [f64::INFINITY; 2]);
    loop {
        let motion = match behaviour.step(&AToBObservation { pose, done: true, stalled: false }).unwrap() {
            Some(Manoeuvre::Speed(twist)) => {
                Displacement { length: 0.02 * twist.linear, angle: 0.02 * twist.angular }
            }
            Some(Manoeuvre::Straight(length, _)) => Displacement { length, angle: 0.0 },
            Some(Manoeuvre::Turn(angle, _)) => Displacement { length: 0.0, angle },
            Some(Manoeuvre::Continue) => Displacement::default(),
            None => break,
        };
        pose = advance(pose, motion);
        for (least, point) in least.iter_mut().zip(via) {
            *least = least.min(pose.distance_to(point));
        }
    }
    assert!(least.iter().all(|&least| least < 0.02), "{least:?}");
    assert!(pose.distance_to(goal.position) < 1e-3 && (pose.heading - 0.5).abs() < 2e-3, "{pose:?}");
    // A round trip begins where it ends.
    let round = AToB::new(Method::Spline, Goal::point(Point::origin()), AToBParameters::default());
    let plan = round.unwrap().via(via.to_vec()).unwrap().plan(Pose::default()).unwrap().unwrap();
    assert!(plan.length() > 2.0);
    assert!(drive(Method::Arc).via(via.to_vec()).is_err());
    assert!(drive(Method::Spline).via(vec![Point::new(f64::NAN, 0.0)]).is_err());
}

#[test]
fn who_is_there_stays() {
    let there = Pose::new(1.0, 2.0, 0.5);
    assert_eq!(drive(Method::Spline, Goal::pose(there), there), (there, 0));
}

#[test]
fn a_dog_curve_bends_less_and_less() {
    let parameters = PathFollowerParameters::default();
    let turns = [1.0, 0.5, 0.1, 0.0].map(|bearing| dog_twist(&parameters, bearing, 1.0).angular);
    assert!(turns.windows(2).all(|pair| pair[0] > pair[1]) && turns[3] == 0.0, "{turns:?}");
    assert_eq!(dog_twist(&parameters, 0.0, 1.0).linear, parameters.speed);
}

#[test]
fn wrong_numbers_are_refused() {
    let goal = Goal::point(Point::new(f64::NAN, 0.0));
    assert!(AToB::new(Method::Turn, goal, AToBParameters::default()).is_err());
    let goal = Goal::point(Point::new(1.0, 0.0));
    let parameters = AToBParameters { tolerance: 0.0, ..AToBParameters::default() };
    assert!(AToB::new(Method::Turn, goal, parameters).is_err());
    let mut drive = AToB::new(Method::Turn, goal, AToBParameters::default()).unwrap();
    let lost = AToBObservation { pose: Pose::new(f64::NAN, 0.0, 0.0), done: true, stalled: false };
    assert!(drive.step(&lost).is_err());
}
