use std::error::Error;

use roverlab::geometry::Pose;
use roverlab::io::control::{Command, Senses, run};
use roverlab::io::sim::{SimOptions, SimRobot, Simulation};
use roverlab::kinematics::OdometryErrors;
use roverlab::world::{RobotSpec, Scene, World};

/// What every field is given.
const NONSENSE: [f64; 6] = [f64::NAN, f64::NEG_INFINITY, -1.0, 0.0, 1e300, f64::INFINITY];

/// What of it a field accepts.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Takes {
    /// None of it: the range has both ends, and is above 0.
    Bounded,
    /// A range that begins with 0.
    BoundedFromZero,
    /// All that is above 0 and finite.
    Positive,
    /// 0 as well.
    NotNegative,
    /// All that is finite.
    Finite,
    /// A range from below 0 to above it.
    AroundZero,
    /// All that is above 0.
    Above,
    /// All from 0.
    FromZero,
    /// A whole number of at least 1.
    Count,
    /// A whole number.
    AnyCount,
    /// A whole number up to some limit.
    CountUpTo,
    /// Two whole numbers up to some limit, the lower one first.
    CountRange,
}

impl Takes {
    fn accepts(self, slot: usize, value: f64) -> bool {
        let whole = value as usize;
        match self {
            Self::Bounded => false,
            Self::BoundedFromZero => value == 0.0,
            Self::Positive => value > 0.0 && value.is_finite(),
            Self::NotNegative => value >= 0.0 && value.is_finite(),
            Self::Finite => value.is_finite(),
            Self::AroundZero => value == -1.0 || value == 0.0,
            Self::Above => value > 0.0,
            Self::FromZero => value >= 0.0,
            Self::Count => whole > 0,
            Self::AnyCount => true,
            Self::CountUpTo => whole == 0,
            Self::CountRange => slot == 0 && whole == 0,
        }
    }
}

/// A field of one number or of several.
pub(crate) trait Slots {
    fn slots(&self) -> usize {
        1
    }

    fn put(&mut self, slot: usize, value: f64);
}

macro_rules! slots {
    ($($type:ty, $count:expr, |$field:ident, $slot:ident, $value:ident| $put:expr;)+) => {
        $(impl Slots for $type {
            fn slots(&self) -> usize {
                $count
            }

            fn put(&mut self, $slot: usize, $value: f64) {
                let ($field, _) = (self, $slot);
                $put;
            }
        })+
    };
}

slots! {
    f64, 1, |field, slot, value| *field = value;
    usize, 1, |field, slot, value| *field = value as usize;
    u32, 1, |field, slot, value| *field = value as u32;
    u16, 1, |field, slot, value| *field = value as u16;
    OdometryErrors, 4, |field, slot, value| {
        let OdometryErrors { wheel_scale, wheel_mismatch, track, slip } = field;
        *[wheel_scale, wheel_mismatch, track, slip][slot] = value;
    };
    Option<f64>, 1, |field, slot, value| *field = Some(value);
    [f64; 2], 2, |field, slot, value| field[slot] = value;
    (f64, f64), 2, |field, slot, value| *(if slot == 0 { &mut field.0 } else { &mut field.1 }) = value;
    (usize, usize), 2, |field, slot, value| *(if slot == 0 { &mut field.0 } else { &mut field.1 }) = value as usize;
}

/// A field with what it was given and what came of it.
pub(crate) struct Given {
    pub(crate) field: &'static str,
    pub(crate) takes: Takes,
    pub(crate) slot: usize,
    pub(crate) value: f64,
    pub(crate) answer: Result<(), Box<dyn Error>>,
}

impl Given {
    /// What is wrong with it.
    pub(crate) fn wrong(&self) -> Option<String> {
        let Self { field, takes, slot, value, answer } = self;
        let accepts = takes.accepts(*slot, *value);
        match answer {
            Ok(()) if accepts => None,
            Ok(()) => Some(format!("{field}[{slot}] = {value} is accepted")),
            Err(error) if accepts => Some(format!("{field}[{slot}] = {value} is refused: {error}")),
            Err(error) => {
                let text = error.to_string().to_lowercase();
                let named = field.split('_').all(|word| text.contains(word)) && text.contains("expected");
                (!named).then(|| format!("{field}[{slot}] = {value} is refused without its name: {text}"))
            }
        }
    }
}

pub(crate) fn nonsense() -> impl Iterator<Item = f64> {
    NONSENSE.into_iter()
}

/// Gives nonsense to every field of a struct, and names all of its fields: one that is added later has to be
/// listed.
macro_rules! check {
    ($type:ident = $base:expr, |$parameters:ident| $new:expr,
     { $($takes:ident: $($field:ident),+;)+ } $(but $($rest:ident),+)?) => {{
        let base: $type = $base;
        let $type { $($($field: _,)+)+ $($($rest: _,)+)? } = base.clone();
        let mut wrong: Vec<String> = Vec::new();
        $($(
            for slot in 0..$crate::check::Slots::slots(&base.$field) {
                for value in $crate::check::nonsense() {
                    #[allow(clippy::clone_on_copy)]
                    let mut $parameters = base.clone();
                    $crate::check::Slots::put(&mut $parameters.$field, slot, value);
                    let made = || -> Result<(), Box<dyn std::error::Error>> { $new; Ok(()) };
                    let takes = $crate::check::Takes::$takes;
                    let given = $crate::check::Given { field: stringify!($field), takes, slot, value, answer: made() };
                    wrong.extend(given.wrong());
                }
            }
        )+)+
        assert!(wrong.is_empty(), "{}:\n{}", stringify!($type), wrong.join("\n"));
    }};
}
pub(crate) use check;

/// The same for every field of a variant of an enum.
macro_rules! check_variant {
    ($type:ident::$variant:ident = $base:expr, |$parameters:ident| $new:expr,
     { $($takes:ident: $($field:ident),+;)+ } $(but $($rest:ident),+)?) => {{
        let base: $type = $base;
        let mut wrong: Vec<String> = Vec::new();
        let $type::$variant { $($($field: _,)+)+ $($($rest: _,)+)? } = base.clone() else { panic!("another variant") };
        $($(
            for value in $crate::check::nonsense() {
                let mut $parameters = base.clone();
                if let $type::$variant { $field, .. } = &mut $parameters {
                    $crate::check::Slots::put($field, 0, value);
                }
                let made = || -> Result<(), Box<dyn std::error::Error>> { $new; Ok(()) };
                let (field, takes) = (stringify!($field), $crate::check::Takes::$takes);
                wrong.extend($crate::check::Given { field, takes, slot: 0, value, answer: made() }.wrong());
            }
        )+)+
        assert!(wrong.is_empty(), "{}:\n{}", stringify!($variant), wrong.join("\n"));
    }};
}
pub(crate) use check_variant;

/// Runs a behaviour for a moment; how it ends does not matter, but that it does.
pub(crate) fn ends<B>(spec: RobotSpec, mut behaviour: B)
where
    B: Senses<SimRobot>,
    B::Command: Command<SimRobot>,
{
    let simulation = simulation(spec);
    let mut robot = simulation.robot(0).expect("a robot");
    let _ = run(&mut robot, &mut behaviour, 0.4, |_, _, _| {});
}

/// A robot in a room, for ten seconds at most.
pub(crate) fn simulation(spec: RobotSpec) -> Simulation {
    let scene = Scene::with_robot(World::walled(3.0, 2.0), spec, Pose::new(1.0, 1.0, 0.3));
    let options = SimOptions { time_limit: Some(10.0), ..SimOptions::default() };
    Simulation::new(&scene, options).expect("a simulation")
}
