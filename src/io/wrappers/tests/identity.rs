use proptest::collection::vec;
use proptest::prelude::*;

use super::{CALLS, busy_robot, calls};
use crate::io::wrappers::{Fault, Faulty, Limited, Limits, Noise, Noisy, Stamp, Traced};
use crate::io::{MockRobot, RobotIo};
use crate::random::Stream;

/// Makes the same calls on a bare and a wrapped robot; answers and commands must match.
fn assert_identity<W: RobotIo>(
    numbers: &[u8],
    wrap: impl FnOnce(MockRobot) -> W,
    unwrap: impl FnOnce(W) -> MockRobot,
) {
    let mut bare = busy_robot();
    let mut wrapped = wrap(busy_robot());
    assert_eq!(calls(&mut wrapped, numbers), calls(&mut bare, numbers));
    let inside = unwrap(wrapped);
    assert_eq!(inside.calls(), bare.calls());
    assert_eq!(inside.display().frame(), bare.display().frame());
}

proptest! {
    #![proptest_config(crate::testing::cases(48))]

    #[test]
    fn no_noise_changes_nothing(numbers in vec(0..CALLS, 0..60), seed: u64) {
        let stream = Stream::new(seed);
        assert_identity(&numbers, |r| Noisy::new(r, Noise::NONE, &stream).unwrap(), Noisy::into_inner);
    }

    #[test]
    fn no_fault_changes_nothing(numbers in vec(0..CALLS, 0..60)) {
        assert_identity(&numbers, |r| Faulty::new(r, vec![]), Faulty::into_inner);
    }

    #[test]
    fn no_limit_changes_nothing(numbers in vec(0..CALLS, 0..60)) {
        assert_identity(&numbers, |r| Limited::new(r, Limits::default()).unwrap(), Limited::into_inner);
    }

    #[test]
    fn a_silent_trace_changes_nothing(numbers in vec(0..CALLS, 0..60)) {
        let wrap = |r| Traced::new(r, std::io::sink()).with_stamp(Stamp::LastKnown);
        assert_identity(&numbers, wrap, Traced::into_inner);
    }

    #[test]
    fn a_stack_of_idle_wrappers_changes_nothing(numbers in vec(0..CALLS, 0..60)) {
        let stream = Stream::new(3);
        assert_identity(
            &numbers,
            |r| {
                let r = Noisy::new(r, Noise::NONE, &stream).unwrap();
                let r = Limited::new(Faulty::new(r, vec![]), Limits::default()).unwrap();
                Traced::new(r, std::io::sink()).with_stamp(Stamp::LastKnown)
            },
            |w| w.into_inner().into_inner().into_inner().into_inner(),
        );
    }

    /// Future faults change no answer; only reading the clock takes time, which is none here.
    #[test]
    fn faults_to_come_change_nothing_yet(numbers in vec(0..CALLS, 0..40)) {
        let all = "stuck@1e6 lost@1e6 nan@1e6 jump@1e6 late@1e6 link@1e6 hang@1e6 clock@1e6 clock=3@1e6";
        let faults = all.split(' ').map(|text| text.parse::<Fault>().unwrap()).collect();
        let mut bare = busy_robot().with_call_charge(0.0);
        let mut faulty = Faulty::new(busy_robot().with_call_charge(0.0), faults);
        prop_assert_eq!(calls(&mut faulty, &numbers), calls(&mut bare, &numbers));
    }
}

fn takes_a_full_robot<R: RobotIo>(mut robot: R) -> Vec<String> {
    calls(&mut robot, &[0, 14, 2, 1, 4])
}

#[test]
fn references_boxes_and_wrappers_of_them_are_full_robots() {
    let stream = Stream::new(1);
    let expected = takes_a_full_robot(busy_robot());

    let mut robot = busy_robot();
    assert_eq!(takes_a_full_robot(&mut robot as &mut dyn RobotIo), expected);
    assert_eq!(takes_a_full_robot(Box::new(busy_robot()) as Box<dyn RobotIo>), expected);

    let mut robot = busy_robot();
    let dynamic: &mut dyn RobotIo = &mut robot;
    assert_eq!(takes_a_full_robot(Noisy::new(dynamic, Noise::NONE, &stream).unwrap()), expected);
    let mut robot = busy_robot();
    let dynamic: &mut dyn RobotIo = &mut robot;
    assert_eq!(takes_a_full_robot(Faulty::new(dynamic, vec![])), expected);
    let boxed: Box<dyn RobotIo> = Box::new(busy_robot());
    assert_eq!(takes_a_full_robot(Limited::new(boxed, Limits::default()).unwrap()), expected);
    let boxed: Box<dyn RobotIo> = Box::new(busy_robot());
    let traced = Traced::new(boxed, std::io::sink()).with_stamp(Stamp::LastKnown);
    let dynamic: Box<dyn RobotIo> = Box::new(traced);
    assert_eq!(takes_a_full_robot(dynamic), expected);
}
