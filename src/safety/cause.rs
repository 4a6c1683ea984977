// This file compiles without the standard library.

/// A set of causes that forbid automatic driving.
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
    /// Emergency button on board, which cuts the power. Hard.
    pub const EMERGENCY_BUTTON: Self = Self(1);
    /// A stop button of the base station. Hard.
    pub const REMOTE_STOP: Self = Self(1 << 1);
    /// The base station's heartbeat is missing. Soft.
    pub const HEARTBEAT_LOST: Self = Self(1 << 2);
    /// The vehicle is outside its fence. Soft. A vehicle with an unknown position reports
    /// [`SENSOR`](Self::SENSOR) instead.
    pub const OUTSIDE_FENCE: Self = Self(1 << 3);
    /// The driving program is silent, or only reads while its last command keeps the vehicle moving. Soft.
    pub const WATCHDOG: Self = Self(1 << 4);
    /// A sensor is frozen, lost, late or reads NaN, or odometry jumped. Soft. The cause stays until somebody
    /// confirms the sensors.
    pub const SENSOR: Self = Self(1 << 5);
    /// The clock stands still or runs backwards. Soft.
    pub const CLOCK: Self = Self(1 << 6);
    /// The vehicle does not respond. Soft.
    pub const LINK: Self = Self(1 << 7);
    /// The driver uses a pedal, the steering wheel or the disengage button. Not a fault.
    pub const DRIVER: Self = Self(1 << 8);

    /// Causes of an emergency stop.
    const HARD: Self = Self::EMERGENCY_BUTTON.with(Self::REMOTE_STOP);

    /// Union of two sets.
    #[must_use]
    pub const fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Union with `other` if `condition` holds.
    #[must_use]
    pub const fn with_if(self, condition: bool, other: Self) -> Self {
        if condition { self.with(other) } else { self }
    }

    /// The set without the causes in `other`.
    #[must_use]
    pub const fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// Whether the two sets have a cause in common.
    pub const fn has(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// Whether the set is empty.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Whether the set contains a hard cause: brake as hard as possible.
    pub const fn is_hard(self) -> bool {
        self.has(Self::HARD)
    }

    /// Whether the set contains a soft cause. [`DRIVER`](Self::DRIVER) is neither soft nor hard.
    pub const fn is_soft(self) -> bool {
        !self.without(Self::HARD).without(Self::DRIVER).is_empty()
    }

    /// Names of the causes, in bit order.
    pub fn names(self) -> impl Iterator<Item = &'static str> {
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

    /// The set with these bits; unknown bits are ignored.
    pub const fn from_bits(bits: u16) -> Self {
        Self(bits & 0x1ff)
    }

    /// The set as bits.
    pub const fn bits(self) -> u16 {
        self.0
    }
}

/// Requests of the operator. Each is a level; only its rising edge counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Requests {
    /// Get ready for automatic driving.
    pub arm: bool,
    /// Start automatic driving.
    pub start: bool,
    /// Return to manual driving.
    pub disarm: bool,
}
