//! Options without meaning for races between cones.

use crate::common::{CommonArgs, Failure};

/// Fails for an option without meaning for a race.
pub(crate) fn check_race(common: &CommonArgs) -> Result<(), Failure> {
    let places = [
        ("--world", common.world.is_some()),
        ("--robot", common.robot.is_some()),
        ("--start", common.start.is_some()),
        ("--goal", common.goal.is_some()),
    ];
    refuse(&places, "has no meaning for a race; expected a command line without it")?;
    let robios = [("--quantised", common.quantised), ("--robios", common.robios.is_some())];
    refuse(&robios, "found a racing car, which is no robot of RoBIOS; expected a command line without it")?;
    let paced = [("--realtime", common.realtime)];
    refuse(&paced, "a race is not paced by the wall clock; expected a command line without it")
}

/// Fails for an option without meaning for races on many tracks, in addition to those of one race.
pub(crate) fn check_campaign(common: &CommonArgs) -> Result<(), Failure> {
    common.check_placeless("the tracks of a campaign are drawn")?;
    refuse(&[("--supervised", common.supervised)], "found a campaign; expected it with one race")
}

/// Fails for the first given option of a list, with the reason.
pub(crate) fn refuse(options: &[(&str, bool)], wrong: &str) -> Result<(), Failure> {
    let given = options.iter().find(|(_, given)| *given);
    given.map_or(Ok(()), |(option, _)| Err(Failure::input(format!("{option}: {wrong}"))))
}
