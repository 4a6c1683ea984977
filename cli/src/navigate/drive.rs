use roverlab::geometry::{Point, Pose};
use roverlab::io::{self, Clock, Drive, Lidar, Odometry, control};
use roverlab::nav::{Navigator, NavigatorEvent, NavigatorOutcome, NavigatorParameters};
use roverlab::world::World;

/// How a drive ended, as the robot takes it.
#[derive(Debug, Clone)]
pub(crate) struct Arrival {
    pub(crate) outcome: NavigatorOutcome,
    pub(crate) events: Vec<NavigatorEvent>,
    /// Where the robot takes itself to be.
    pub(crate) believed: Pose,
    /// The first plan.
    pub(crate) plan: Vec<Point>,
    /// Where it has seen something that it was not told of.
    pub(crate) seen: Vec<Point>,
}

impl Arrival {
    /// Length and clearance of the first plan.
    pub(crate) fn planned(&self) -> Option<(f64, f64)> {
        self.events.iter().find_map(|event| match event {
            NavigatorEvent::Planned { length, clearance } => Some((*length, *clearance)),
            _ => None,
        })
    }

    /// How many events are of a kind.
    pub(crate) fn count(&self, is: impl Fn(&NavigatorEvent) -> bool) -> usize {
        self.events.iter().filter(|event| is(event)).count()
    }

    pub(crate) fn replans(&self) -> usize {
        self.count(|event| matches!(event, NavigatorEvent::Replanned { .. }))
    }

    pub(crate) fn recoveries(&self) -> usize {
        self.count(|event| matches!(event, NavigatorEvent::Blocked { .. } | NavigatorEvent::Doubted { .. }))
    }
}

/// Drives a robot through a world that it is told of. `watch` is called after each step with what happened in it.
pub(crate) fn drive<R: Clock + Drive + Odometry + Lidar + ?Sized>(
    robot: &mut R,
    (known, start, goal): (&World, Pose, Point),
    parameters: NavigatorParameters,
    time_limit: f64,
    mut watch: impl FnMut(&[NavigatorEvent]),
) -> io::Result<Arrival> {
    let mut navigator = Navigator::new(known, start, goal, parameters)?;
    let plan = navigator.path().to_vec();
    let mut events = Vec::new();
    let outcome = control::run(robot, &mut navigator, time_limit, |_, navigator, _| {
        let news = navigator.take_events();
        watch(&news);
        events.extend(news);
    })?;
    Ok(Arrival { outcome, events, believed: navigator.pose(), plan, seen: navigator.unknown_obstacles() })
}
