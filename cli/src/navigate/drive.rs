use roverlab::geometry::{Point, Pose};
use roverlab::io::{self, Clock, Drive, Lidar, Odometry, control};
use roverlab::nav::{Navigator, NavigatorEvent, NavigatorOutcome, NavigatorParameters};
use roverlab::world::World;

/// Outcome of a drive from the robot's perspective.
#[derive(Debug, Clone)]
pub(crate) struct Arrival {
    pub(crate) outcome: NavigatorOutcome,
    pub(crate) events: Vec<NavigatorEvent>,
    /// The robot's pose estimate.
    pub(crate) believed: Pose,
    /// First plan.
    pub(crate) plan: Vec<Point>,
    /// Seen obstacles missing from the map.
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

    /// Number of events of a kind.
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

/// Drives a robot through a mapped world. `watch` is called after each step with its events.
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
