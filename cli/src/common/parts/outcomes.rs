//! Types of the library in results.

use roverlab::drive::traffic::{EvasionRow, EvasionScore};
use roverlab::io::Mishap;
use roverlab::nav::{BugKind, BugOutcome, NavigatorOutcome, RampOutcome};

use super::portable;

portable!(
    enum BugKind {
        Bug1,
        Bug2,
        Alg1,
        Alg2,
        DistBug,
        TangentBug,
        OneBug,
        LeaveBug,
        Rev1,
        Rev2,
        Class1,
    }
);

portable!(
    enum BugOutcome {
        Reached,
        Unreachable,
        NoRoom,
        TimedOut,
        Stopped,
    }
);

portable!(
    enum NavigatorOutcome {
        Reached,
        Unreachable,
        NoRoom,
        Stuck,
        TimedOut,
        Stopped,
    }
);

portable!(
    enum RampOutcome {
        Crossed,
        NoWayUp,
        NoWayDown,
        Stuck,
        TimedOut,
        Stopped,
    }
);

portable!(
    enum Mishap {
        Tipped,
        Fell,
        Stuck,
        Drowned,
        Broken,
    }
);

portable!(struct EvasionRow { seen, right, neutral, negative });

portable!(struct EvasionScore {
    time, laps, rows, collisions, departures, speedings, is_taken_over,
});
