use roverlab::geometry::{Vector, direction, units};
use roverlab::random::Stream;
use roverlab::world::Water;
use serde_json::json;

use super::{Args, LIMIT, Plan, SETTLING, dive, options, scene};
use crate::common::{Failure, Report, Stage, campaign_report, portable, rounded, wrong_seeds};

/// Depths between which a dive leads (m), and how far.
const DEPTHS: [f64; 2] = [0.25, 1.45];
const STEPS: [f64; 2] = [0.2, 1.2];
/// How far the model is off, and the fastest current (m/s).
const MASS: f64 = 0.05;
const THRUST: f64 = 0.10;
const CURRENT: f64 = 0.1;
/// The heading's most root mean square over all dives, in degrees: half of it is the compass's own.
const HEADING: f64 = 1.0;
/// Dives without `--runs`.
const DIVES: u64 = 1000;

/// A dive of the campaign.
fn plan(args: &Args, seed: u64) -> Plan {
    let mut stream = Stream::new(seed).child("dives", 0);
    let step = stream.between(STEPS[0], STEPS[1]);
    let shallow = stream.between(DEPTHS[0], DEPTHS[1] - step);
    let down = stream.between(-1.0, 1.0) > 0.0;
    let (start, depth) = if down { (shallow, shallow + step) } else { (shallow + step, shallow) };
    let current: Vector = direction(stream.between(-3.1, 3.1)) * stream.between(0.0, CURRENT);
    Plan {
        noise: args.common.noise,
        seed,
        start: Some(start),
        depth,
        mass: 1.0 + stream.between(-MASS, MASS),
        thrust: 1.0 + stream.between(-THRUST, THRUST),
        water: Water { current: vec![(0.0, current)], ..Water::default() },
    }
}

/// What came of a dive.
#[derive(Debug, Clone)]
struct Trial {
    is_good: bool,
    contacts: u32,
    settle: Option<f64>,
    overshoot: f64,
    within: f64,
    heading_rms: f64,
}

portable!(struct Trial { is_good, contacts, settle, overshoot, within, heading_rms });

/// Work of the campaign.
pub(super) fn campaign(args: &Args) -> Result<Report, Failure> {
    let dives = args.trials.trials(&args.common, "dives", DIVES, |seed| {
        let plan = plan(args, seed);
        let scene = scene(&plan);
        let stage = Stage::simulated(&scene, options(&plan, LIMIT), Vec::new())?;
        let done = dive(&plan, &scene, &stage, LIMIT, |_| {})?;
        Ok(Trial {
            is_good: done.is_good(),
            contacts: done.end.contacts,
            settle: done.settle,
            overshoot: done.overshoot,
            within: done.within,
            heading_rms: done.heading_rms,
        })
    })?;
    let wrong = wrong_seeds(&dives, |done| done.is_good);
    let worst = |of: &dyn Fn(&Trial) -> f64| dives.iter().map(|(_, done)| of(done)).fold(0.0, f64::max);
    let latest = worst(&|done| done.settle.unwrap_or(f64::INFINITY));
    let overshoot = worst(&|done| done.overshoot);
    let squares: f64 = dives.iter().map(|(_, done)| done.heading_rms * done.heading_rms).sum();
    let heading = (squares / dives.len().max(1) as f64).sqrt();
    let least = dives.iter().map(|(_, done)| done.within).fold(1.0, f64::min);
    let contacts: u64 = dives.iter().map(|(_, done)| u64::from(done.contacts)).sum();
    let good = dives.len() - wrong.len();
    args.common.tell("dives    good  contacts  latest to settle  overshoot  least within 10 mm  heading");
    args.common.tell(format_args!(
        "{:>5}  {good:>6}  {contacts:>8}  {latest:>14.1} s  {:>6.1} mm  {:>16.1} %  {:>4.2} deg",
        dives.len(),
        units::to_mm(overshoot),
        100.0 * least,
        units::to_deg(heading),
    ));
    args.common.tell(format_args!(
        "good: settles within {SETTLING} s, at most 50 mm beyond, then within 10 mm for 95 %, no contact;\n\
         heading within {HEADING} degree in the root mean square of all",
    ));
    let passed = wrong.is_empty() && heading <= units::from_deg(HEADING);
    let row = json!({
        "runs": dives.len(),
        "good": good,
        "contacts": contacts,
        "latest_settle_s": if latest.is_finite() { Some(rounded(latest)) } else { None },
        "most_overshoot_mm": rounded(units::to_mm(overshoot)),
        "least_within_10mm_percent": rounded(100.0 * least),
        "heading_rms_deg": rounded(units::to_deg(heading)),
    });
    Ok(campaign_report(passed, contacts, &wrong).table("rows", vec![row]))
}
