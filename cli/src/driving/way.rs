use roverlab::drive::Method;

/// Driving method by its name on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Way {
    /// Turn, on the spot or on the turning circle, then drive straight.
    Turn,
    /// One arc.
    Arc,
    /// Always turning towards the goal.
    Dog,
    /// A Hermite spline.
    Spline,
}

impl Way {
    pub(crate) const ALL: [Self; 4] = [Self::Turn, Self::Arc, Self::Dog, Self::Spline];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Turn => "turn",
            Self::Arc => "arc",
            Self::Dog => "dog",
            Self::Spline => "spline",
        }
    }

    pub(crate) fn method(self) -> Method {
        match self {
            Self::Turn => Method::Turn,
            Self::Arc => Method::Arc,
            Self::Dog => Method::Dog,
            Self::Spline => Method::Spline,
        }
    }
}
