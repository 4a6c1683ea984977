use std::f64::consts::FRAC_PI_6;
use std::path::Path;

use roverlab::geometry::{math, units};
use roverlab::io::Result;
use roverlab::io::sim::starman::{BodyPlan, LIMBS, LimbPlan, Starman, StarmanSpec};
use serde::Deserialize;

use crate::common::{CommonArgs, Failure, toml_places};

/// Body that learns to walk.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Figure {
    /// The book's robot, or the figure that it is based on.
    Star(StarmanSpec),
    /// Limbs on limbs.
    Tree(BodyPlan),
}

/// Bodies that are known by name.
const KNOWN: [(&str, &str); 4] = [
    ("biped", include_str!("../../figures/biped.toml")),
    ("hexapod", include_str!("../../figures/hexapod.toml")),
    ("star", include_str!("../../figures/star.toml")),
    ("worm", include_str!("../../figures/worm.toml")),
];
/// Bytes of a genome for each limb of a body that evolves: its length and its direction at rest.
const GENES: usize = 2;
/// Largest factor by which evolution stretches or shortens a limb.
const STRETCHED: f64 = 4.0;
/// Largest change of a limb's direction by evolution (rad).
const BENT: f64 = FRAC_PI_6;

/// File of a body. Lengths in millimetres, masses in grams, angles in degrees.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    friction: f64,
    servo_speed: f64,
    servo_torque: f64,
    body: Body,
    #[serde(rename = "limb")]
    limbs: Vec<Limb>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Body {
    length: f64,
    radius: f64,
    mass: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Limb {
    /// Number of the limb that carries it, from 1; 0 for the body.
    #[serde(default)]
    on: usize,
    hinge: [f64; 2],
    rest: f64,
    length: f64,
    radius: f64,
    mass: f64,
    range: f64,
}

impl Figure {
    /// A figure by its name or its file.
    pub(crate) fn load(common: &CommonArgs, name: &str) -> std::result::Result<Self, Failure> {
        match Self::named(name) {
            Some(figure) => Ok(figure),
            None if is_name(name) => {
                let known: Vec<&str> = KNOWN.iter().map(|(name, _)| *name).collect();
                let known = known.join(", ");
                Err(Failure::input(format!(
                    "--figure {name}: expected book, planar, {known}, or a file of a body, .toml"
                )))
            }
            None => {
                let bytes = common.read("figure", Path::new(name)).map_err(Failure::input)?;
                Self::parse(&String::from_utf8_lossy(&bytes), name)
            }
        }
    }

    /// A figure by its name.
    pub(crate) fn named(name: &str) -> Option<Self> {
        match name {
            "book" => Some(Self::Star(StarmanSpec::book())),
            "planar" => Some(Self::Star(StarmanSpec::planar())),
            _ => {
                let (_, text) = KNOWN.iter().find(|(known, _)| *known == name)?;
                Self::parse(text, name).ok()
            }
        }
    }

    /// A body from a file's text.
    pub(crate) fn parse(text: &str, name: &str) -> std::result::Result<Self, Failure> {
        let file: File = toml::from_str(text).map_err(|error| {
            let place = toml_places::of_byte(text, error.span().map_or(0, |span| span.start));
            Failure::input(format!("{name}:{place}: {}", error.message().replace('\n', ", ")))
        })?;
        let plan = file.plan();
        plan.validate().map_err(|error| {
            let message = error.to_string();
            let place = toml_places::of_value(text, &path(&message));
            Failure::input(format!("{name}:{place}: {message}"))
        })?;
        Ok(Self::Tree(plan))
    }

    /// Number of servos.
    pub(crate) fn servos(&self) -> usize {
        match self {
            Self::Star(_) => LIMBS,
            Self::Tree(plan) => plan.limbs.len(),
        }
    }

    /// Number of bytes by which its body evolves; none for a star, whose limbs are alike.
    pub(crate) fn genes(&self) -> usize {
        match self {
            Self::Star(_) => 0,
            Self::Tree(plan) => GENES * plan.limbs.len(),
        }
    }

    /// The robot, with a body changed by genes: 128 leaves it as it is.
    pub(crate) fn robot(&self, time_step: f64, genes: &[u8]) -> Result<Starman> {
        match self {
            Self::Star(spec) => Starman::new(&StarmanSpec { time_step, ..*spec }),
            Self::Tree(plan) => {
                let mut plan = BodyPlan { time_step, ..plan.clone() };
                for (limb, genes) in plan.limbs.iter_mut().zip(genes.chunks_exact(GENES)) {
                    change(limb, genes);
                }
                stretch(&mut plan, self);
                Starman::of(&plan)
            }
        }
    }

    /// Half the length of the body, and its radius (m).
    pub(crate) fn outline(&self) -> (f64, f64) {
        match self {
            Self::Star(spec) => (0.0, spec.body_radius),
            Self::Tree(plan) => (0.5 * plan.length, plan.radius),
        }
    }
}

/// Path in a file of the parameter that an error of a plan begins with.
fn path(message: &str) -> Vec<String> {
    let name = message.split(" is ").next().unwrap_or_default();
    let of_limb = |number: &str, key: &str| {
        let index = number.parse::<usize>().unwrap_or_default().saturating_sub(1);
        vec!["limb".into(), index.to_string(), key.into()]
    };
    if let Some(number) = name.strip_prefix("parent of limb ") {
        return of_limb(number, "on");
    }
    match name.strip_prefix("limb ").and_then(|rest| rest.split_once(": ")) {
        Some((number, key)) => of_limb(number, key),
        None => match name.strip_prefix("body ") {
            Some(key) => vec!["body".into(), key.into()],
            None => vec![name.replace(' ', "_")],
        },
    }
}

/// Whether it is a name and no file.
pub(crate) fn is_name(text: &str) -> bool {
    Path::new(text).extension().is_none()
}

/// Changes a limb by its genes. Its mass grows with its length.
fn change(limb: &mut LimbPlan, genes: &[u8]) {
    let share = |gene: u8| (f64::from(gene) - 128.0) / 128.0;
    let factor = math::pow(STRETCHED, share(genes[0]));
    limb.length *= factor;
    limb.mass *= factor;
    limb.rest += BENT * share(genes[1]);
}

/// Moves the hinges of limbs on limbs along with the length of those.
fn stretch(plan: &mut BodyPlan, before: &Figure) {
    let Figure::Tree(before) = before else { return };
    for index in 0..plan.limbs.len() {
        if let Some(parent) = plan.limbs[index].parent {
            let factor = plan.limbs[parent].length / before.limbs[parent].length;
            plan.limbs[index].hinge[0] *= factor;
        }
    }
}

impl File {
    fn plan(&self) -> BodyPlan {
        let mm = units::from_mm;
        let limb = |limb: &Limb| LimbPlan {
            parent: limb.on.checked_sub(1),
            hinge: limb.hinge.map(mm),
            rest: units::from_deg(limb.rest),
            length: mm(limb.length),
            radius: mm(limb.radius),
            mass: 1e-3 * limb.mass,
            range: units::from_deg(limb.range),
        };
        BodyPlan {
            length: mm(self.body.length),
            radius: mm(self.body.radius),
            mass: 1e-3 * self.body.mass,
            limbs: self.limbs.iter().map(limb).collect(),
            friction: self.friction,
            servo_speed: units::from_deg(self.servo_speed),
            servo_torque: self.servo_torque,
            ..BodyPlan::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use roverlab::io::{Clock, Odometry};

    #[test]
    fn every_known_body_stands() {
        for (name, _) in KNOWN {
            let figure = Figure::named(name).unwrap_or_else(|| panic!("{name}"));
            let mut robot = figure.robot(0.01, &vec![128; figure.genes()]).unwrap();
            let before = robot.truth().posture.body.1;
            robot.wait(2.0).unwrap();
            let posture = robot.truth().posture;
            println!("{name}: {posture:?}");
            assert!(
                (posture.body.1 - before).abs() < 0.02 && posture.roll.abs() < 0.3,
                "{name}: {posture:?}"
            );
            assert!(robot.pose().unwrap().x.abs() < 0.02, "{name}");
        }
    }

    /// The file of the star is the book's Starman.
    #[test]
    fn the_star_is_one_file_of_bodies() {
        let [star, book] = ["star", "book"].map(|name| Figure::named(name).unwrap());
        let [one, other] = [star, book].map(|figure| figure.robot(0.01, &[]).unwrap().truth().posture);
        assert!((one.body.1 - other.body.1).abs() < 1e-3, "{one:?} {other:?}");
        for (one, other) in one.segments.iter().flatten().zip(other.segments.iter().flatten()) {
            assert!((one.0 - other.0).abs() < 1e-3 && (one.1 - other.1).abs() < 1e-3, "{one:?} {other:?}");
        }
    }

    #[test]
    fn genes_change_the_body() {
        let figure = Figure::named("biped").unwrap();
        let mut genes = vec![128; figure.genes()];
        (genes[0], genes[1]) = (255, 0);
        let [plain, changed] =
            [vec![], genes].map(|genes| figure.robot(0.01, &genes).unwrap().truth().posture);
        let length = |posture: &roverlab::io::sim::starman::StarmanPosture| {
            let [(ax, ay), (bx, by)] = posture.segments[0];
            math::hypot(bx - ax, by - ay)
        };
        assert!(length(&changed) > 3.8 * length(&plain), "{changed:?}");
    }

    #[test]
    fn wrong_files_are_refused() {
        let (_, text) = KNOWN[0];
        for (text, expected) in [
            (text.replace("friction", "frction"), "unknown field `frction`"),
            (text.replacen("on = 1", "on = 7", 1), "parent of limb"),
            (text.replacen("mass = ", "mass = -", 1), "body mass"),
            (text.replacen("mass = ", "mass = 1e300 #", 1), "body mass"),
            (text.replacen("friction = ", "friction = 1e300 #", 1), "friction"),
            (text.replacen("range = ", "range = 1e300 #", 1), "limb 1: range"),
        ] {
            let changed = text.lines().zip(KNOWN[0].1.lines()).take_while(|(new, old)| new == old).count();
            let error = Figure::parse(&text, "x.toml").unwrap_err().to_string();
            let place = format!("x.toml:{}:", changed + 1);
            assert!(error.starts_with(&place) && error.contains(expected), "{error}");
        }
    }
}
