// This file compiles without the standard library.

/// A set of reasons against driving by itself.
///
/// ```
/// use roverlab::safety::Causes;
/// let causes = Causes::NONE.with(Causes::SENSOR).with_if(true, Causes::HEARTBEAT_LOST);
/// assert!(causes.has(Causes::SENSOR) && !causes.has(Causes::WATCHDOG));
/// assert_eq!(causes.names().count(), 2);
/// assert_eq!(Causes::from_bits(causes.bits()), causes);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Causes(u16);

impl Causes {
    /// Nothing is wrong.
    pub const NONE: Self = Self(0);
    /// The button on board that takes the power away. Hard.
    pub const EMERGENCY_BUTTON: Self = Self(1);
    /// A stop button of the base station. Hard.
    pub const REMOTE_STOP: Self = Self(1 << 1);
    /// The base station's heartbeat is missing. Soft.
    pub const HEARTBEAT_LOST: Self = Self(1 << 2);
    /// The vehicle is outside its fence. One that does not know where it is has a sensor that is not to be trusted. Soft.
    pub const OUTSIDE_FENCE: Self = Self(1 << 3);
    /// The driving program is silent, or only reads while its last command keeps the vehicle going. Soft.
    pub const WATCHDOG: Self = Self(1 << 4);
    /// A sensor is frozen, lost, late or reads no numbers, or odometry jumps; or one was, and nobody has vouched for it since.
    /// Soft.
    pub const SENSOR: Self = Self(1 << 5);
    /// The clock stands or goes back. Soft.
    pub const CLOCK: Self = Self(1 << 6);
    /// The vehicle does not answer. Soft.
    pub const LINK: Self = Self(1 << 7);
    /// The driver presses a pedal, holds the wheel, or presses the button that disengages: not a fault.
    pub const DRIVER: Self = Self(1 << 8);

    /// Those that take the power away at once.
    const HARD: Self = Self::EMERGENCY_BUTTON.with(Self::REMOTE_STOP);

    /// These and others.
    #[must_use]
    pub const fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// These, and others if they are there.
    #[must_use]
    pub const fn with_if(self, condition: bool, other: Self) -> Self {
        if condition { self.with(other) } else { self }
    }

    /// These without others.
    #[must_use]
    pub const fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// Whether any of the others is among these.
    pub const fn has(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// Whether there are none.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Whether there is a reason to brake as hard as possible.
    pub const fn is_hard(self) -> bool {
        self.has(Self::HARD)
    }

    /// Whether there is a reason to stop, other than a hard one. The driver is none.
    pub const fn is_soft(self) -> bool {
        !self.without(Self::HARD).without(Self::DRIVER).is_empty()
    }

    /// What the causes are called, in the order of their bits.
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        /// The causes' names, in the order of their bits.
        const NAMES: [&str; 9] = [
            "emergency button",
            "remote stop",
            "heartbeat lost",
            "outside the fence",
            "watchdog",
            "sensor",
            "clock",
            "link",
            "driver",
        ];
        NAMES.into_iter().enumerate().filter(move |(bit, _)| self.0 >> bit & 1 == 1).map(|(_, name)| name)
    }

    /// The set that these bits stand for; bits without a meaning are left out.
    pub const fn from_bits(bits: u16) -> Self {
        Self(bits & 0x1ff)
    }

    /// The set as bits.
    pub const fn bits(self) -> u16 {
        self.0
    }
}

/// What people ask for. Each is a level; what counts is when it rises.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Requests {
    /// Make ready to drive by itself.
    pub arm: bool,
    /// Drive by itself.
    pub start: bool,
    /// Be driven by a person again.
    pub disarm: bool,
}
