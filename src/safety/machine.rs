// This file compiles without the standard library.

use super::cause::{Causes, Requests};

/// What a vehicle may do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum SafetyState {
    /// A person drives.
    #[default]
    Manual,
    /// It stands, ready to drive by itself.
    Armed,
    /// It drives by itself.
    Auto,
    /// It brakes as it would on a road, and stands.
    SafeStop,
    /// It brakes as hard as it can, without power, and stands.
    EmergencyStop,
}

impl SafetyState {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Manual, Self::Armed, Self::Auto, Self::SafeStop, Self::EmergencyStop];

    /// How bad it is: 0 without a stop, 1 for a safe one, 2 for an emergency.
    pub const fn severity(self) -> u8 {
        match self {
            Self::Manual | Self::Armed | Self::Auto => 0,
            Self::SafeStop => 1,
            Self::EmergencyStop => 2,
        }
    }

    /// Whether the vehicle has to stop and stand.
    pub const fn is_stop(self) -> bool {
        self.severity() > 0
    }

    /// Whether a program's commands reach the wheels.
    pub const fn lets_drive(self) -> bool {
        matches!(self, Self::Auto)
    }
}

/// What the core is told in each control period.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct SafetyInputs {
    /// What is wrong.
    pub causes: Causes,
    /// What people ask for.
    pub requests: Requests,
    /// Whether the vehicle stands.
    pub standing: bool,
}

/// The state machine. The same inputs lead to the same states, whatever they are.
///
/// ```
/// use roverlab::safety::{Causes, Requests, SafetyCore, SafetyInputs, SafetyState};
/// let mut core = SafetyCore::new();
/// let standing = SafetyInputs { standing: true, ..SafetyInputs::default() };
/// core.step(standing);
/// core.step(SafetyInputs { requests: Requests { arm: true, ..Requests::default() }, ..standing });
/// let start = Requests { start: true, ..Requests::default() };
/// assert_eq!(core.step(SafetyInputs { requests: start, ..standing }), SafetyState::Auto);
/// // The worse cause wins.
/// let causes = Causes::HEARTBEAT_LOST.with(Causes::REMOTE_STOP);
/// assert_eq!(core.step(SafetyInputs { causes, ..SafetyInputs::default() }), SafetyState::EmergencyStop);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct SafetyCore {
    state: SafetyState,
    /// The requests of the last period.
    last: Requests,
}

impl Default for SafetyCore {
    fn default() -> Self {
        Self::new()
    }
}

impl SafetyCore {
    /// A vehicle that a person drives. A request that is there in the first period has not begun: its button may be stuck.
    pub const fn new() -> Self {
        let last = Requests { arm: true, start: true, disarm: true };
        Self { state: SafetyState::Manual, last }
    }

    /// The present state.
    pub const fn state(&self) -> SafetyState {
        self.state
    }

    /// One control period: the state from now on.
    pub const fn step(&mut self, inputs: SafetyInputs) -> SafetyState {
        let SafetyInputs { causes, requests, standing } = inputs;
        let rises = Requests {
            arm: requests.arm && !self.last.arm,
            start: requests.start && !self.last.start,
            disarm: requests.disarm && !self.last.disarm,
        };
        self.last = requests;
        self.state = next(self.state, causes, rises, standing);
        self.state
    }
}

/// The table of transitions.
const fn next(state: SafetyState, causes: Causes, rises: Requests, standing: bool) -> SafetyState {
    use SafetyState::{Armed, Auto, EmergencyStop, Manual, SafeStop};
    if causes.is_hard() {
        return EmergencyStop;
    }
    let may_arm = rises.arm && !rises.disarm && standing && causes.is_empty();
    let to_person = causes.has(Causes::DRIVER) || rises.disarm;
    match state {
        Armed | Auto if causes.is_soft() => SafeStop,
        Armed | Auto if to_person => Manual,
        Armed if rises.start => Auto,
        // Soft causes do not take the wheel from a person: none is asked for here.
        Manual | SafeStop | EmergencyStop if may_arm => Armed,
        unchanged => unchanged,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    /// The reference: rules, the first that applies decides. Written from the description, not from the code.
    fn expected(state: SafetyState, inputs: SafetyInputs, rises: Requests) -> SafetyState {
        use SafetyState::*;
        type Rule = (bool, SafetyState);
        let SafetyInputs { causes, standing, .. } = inputs;
        let hard = causes.has(Causes::EMERGENCY_BUTTON) || causes.has(Causes::REMOTE_STOP);
        let soft = [
            Causes::HEARTBEAT_LOST,
            Causes::OUTSIDE_FENCE,
            Causes::WATCHDOG,
            Causes::SENSOR,
            Causes::CLOCK,
            Causes::LINK,
        ]
        .iter()
        .any(|&cause| causes.has(cause));
        let driver = causes.has(Causes::DRIVER);
        let by_itself = state == Armed || state == Auto;
        let arms = rises.arm && !rises.disarm && standing && !hard && !soft && !driver;
        let rules: [Rule; 6] = [
            (hard, EmergencyStop),
            (by_itself && soft, SafeStop),
            (by_itself && (driver || rises.disarm), Manual),
            (state == Armed && rises.start, Auto),
            (!by_itself && arms, Armed),
            (true, state),
        ];
        rules.iter().find(|(applies, _)| *applies).unwrap().1
    }

    fn random_inputs(random: &mut Stream) -> SafetyInputs {
        let bits = random.bits();
        // Causes are rare enough that every state is visited often.
        let causes = if bits.is_multiple_of(8) {
            Causes::from_bits((random.bits() & random.bits()) as u16)
        } else {
            Causes::NONE
        };
        let bit = |i: u32| bits >> i & 1 == 1;
        let requests = Requests { arm: bit(8), start: bit(9), disarm: bit(10) && bit(11) };
        SafetyInputs { causes, requests, standing: bit(12) || bit(13) }
    }

    /// Ten million transitions against the reference, and the rules that must hold whatever the table says.
    #[test]
    fn random_transitions_follow_the_reference() {
        let steps = 10_000_000;
        let (mut core, mut random) = (SafetyCore::new(), Stream::new(14));
        let mut last = Requests { arm: true, start: true, disarm: true };
        let mut visits = [[0_u32; 5]; 5];
        for _ in 0..steps {
            let (before, inputs) = (core.state(), random_inputs(&mut random));
            let rises = Requests {
                arm: inputs.requests.arm && !last.arm,
                start: inputs.requests.start && !last.start,
                disarm: inputs.requests.disarm && !last.disarm,
            };
            let after = core.step(inputs);
            assert_eq!(after, expected(before, inputs, rises), "{before:?} {inputs:?}");
            if after == SafetyState::Auto && before != SafetyState::Auto {
                assert_eq!(before, SafetyState::Armed, "automatic driving begins armed");
            }
            if before.is_stop() && !after.is_stop() {
                assert!(
                    rises.arm && inputs.standing && inputs.causes.is_empty(),
                    "a stop is left by arming alone"
                );
            }
            if inputs.causes.is_hard() {
                assert_eq!(after, SafetyState::EmergencyStop);
            }
            assert!(after.severity() >= before.severity() || rises.arm, "severity never falls by itself");
            visits[before as usize][after as usize] += 1;
            last = inputs.requests;
        }
        let possible = visits.iter().flatten().filter(|&&count| count > 100).count();
        assert_eq!(possible, 17, "every transition of the table was taken: {visits:?}");
    }

    #[test]
    fn a_button_that_is_stuck_arms_nothing() {
        let mut core = SafetyCore::new();
        let arm = Requests { arm: true, ..Requests::default() };
        let held = SafetyInputs { requests: arm, standing: true, ..SafetyInputs::default() };
        assert_eq!(core.step(held), SafetyState::Manual, "stuck since before the power came");
        core.step(SafetyInputs { causes: Causes::REMOTE_STOP, ..held });
        for _ in 0..10 {
            assert_eq!(core.step(held), SafetyState::EmergencyStop);
        }
        core.step(SafetyInputs { requests: Requests::default(), ..held });
        let both = Requests { disarm: true, ..arm };
        assert_eq!(core.step(SafetyInputs { requests: both, ..held }), SafetyState::EmergencyStop);
        core.step(SafetyInputs { requests: Requests::default(), ..held });
        assert_eq!(core.step(held), SafetyState::Armed);
    }
}
