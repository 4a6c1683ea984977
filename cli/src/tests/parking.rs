//! The command `parking` as a whole.

use super::support::{assert_outcome, run};

#[test]
fn a_car_parks_along_the_road_and_across_it() {
    for kind in ["parallel", "perpendicular"] {
        let ended = run("parking", &["--kind", kind, "--seed", "1", "--noise", "1"]);
        assert_outcome(&ended, "parked");
        assert_eq!(ended.1["legal"], true, "{}", ended.1);
        assert_eq!(ended.1["touched"], false, "{}", ended.1);
    }
}

#[test]
fn a_campaign_has_areas_of_both_kinds() {
    let (_, report, err) = run("parking", &["--campaign", "--runs", "2", "--noise", "1"]);
    assert_eq!((&report["lots"], &report["legal"]), (&2.into(), &2.into()), "{report} {err}");
    let (status, _, err) = run("parking", &["--campaign", "--kind", "parallel"]);
    assert!(status == 2 && err.contains("--kind"), "{err}");
}
