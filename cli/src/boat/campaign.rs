use roverlab::geometry::units;
use serde_json::json;

use super::Args;
use super::job::limit;
use super::lake::{Lake, lake};
use super::voyage::sail;
use crate::common::{Failure, Report, campaign_report, millimetres, portable, wrong_seeds};
use crate::driving::{Conditions, RESERVE};

/// Courses without `--runs`.
const COURSES: u64 = 200;

/// What came of a voyage.
#[derive(Debug, Clone)]
struct Trial {
    is_good: bool,
    contacts: u32,
    miss: Option<f64>,
    cross_track: Option<f64>,
    station: Option<f64>,
}

portable!(struct Trial { is_good, contacts, miss, cross_track, station });

/// The campaign's work.
pub(super) fn campaign(args: &Args) -> Result<Report, Failure> {
    let voyages = args.trials.trials(&args.common, "courses", COURSES, |seed| {
        let Lake { scene, course } = lake(seed)?;
        let limit = args.common.time_limit.unwrap_or_else(|| limit(&scene, &course));
        let conditions =
            Conditions { seed, common: None, reserve: RESERVE, ..Conditions::new(&args.common, limit)? };
        let voyage = sail(&scene, &course, &conditions, |_| {})?;
        Ok(Trial {
            is_good: voyage.is_good(),
            contacts: voyage.run.truth.contacts,
            miss: voyage.miss,
            cross_track: voyage.cross_track,
            station: voyage.station,
        })
    })?;
    let worst = |of: fn(&Trial) -> Option<f64>| {
        voyages.iter().map(|(_, voyage)| of(voyage).unwrap_or(f64::INFINITY)).fold(0.0, f64::max)
    };
    let (miss, track, station) = (worst(|v| v.miss), worst(|v| v.cross_track), worst(|v| v.station));
    let contacts: u64 = voyages.iter().map(|(_, voyage)| u64::from(voyage.contacts)).sum();
    let wrong = wrong_seeds(&voyages, |voyage| voyage.is_good);
    let good = voyages.len() - wrong.len();
    args.common.tell(format_args!(
        "courses   good  contacts  worst miss  worst cross-track rms  worst station rms\n\
         {:>7}  {good:>5}  {contacts:>8}  {:>7.0} mm  {:>18.0} mm  {:>14.0} mm\n\
         good: every waypoint within 500 mm, cross-track rms within 250 mm, station within 300 mm, not aground",
        voyages.len(),
        units::to_mm(miss),
        units::to_mm(track),
        units::to_mm(station)
    ));
    let row = json!({
        "courses": voyages.len(), "good": good, "contacts": contacts, "max_miss_mm": millimetres(miss),
        "max_cross_track_rms_mm": millimetres(track), "max_station_rms_mm": millimetres(station),
    });
    Ok(campaign_report(wrong.is_empty(), contacts, &wrong).table("rows", vec![row]))
}
