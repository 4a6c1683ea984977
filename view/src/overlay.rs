use roverlab::geometry::Point;
use roverlab::picture::{Figure, Item, Mark, Picture};
use serde_json::{Value, json};

/// The additions of a run's picture besides robots, their paths and the page's own marks: what the robot
/// knew, and when. Points are lists of alternating x and y.
pub fn overlay_json(picture: &Picture) -> Value {
    Value::from(picture.items().iter().filter(|item| !is_known(item)).filter_map(item).collect::<Vec<_>>())
}

/// Whether the page draws the item by itself.
fn is_known(item: &Item) -> bool {
    match &item.figure {
        Figure::Robot { .. } => true,
        Figure::Mark { mark, .. } => matches!(mark, Some(Mark::Start | Mark::Goal | Mark::Contact)),
        _ => matches!(item.style.label.as_deref(), Some("true path" | "odometry")),
    }
}

fn item(item: &Item) -> Option<Value> {
    let (kind, points, more) = match &item.figure {
        Figure::Disc { centre, radius } => ("disc", flat(&[*centre]), json!(rounded(*radius))),
        Figure::Polygon(points) => ("polygon", flat(points), Value::Null),
        Figure::Points(points) => ("points", flat(points), Value::Null),
        Figure::Line { points, times, .. } => {
            ("line", flat(points), json!(times.iter().copied().map(rounded).collect::<Vec<_>>()))
        }
        Figure::Mark { mark, position, text } => {
            let name = mark.map(|mark| format!("{mark:?}"));
            ("mark", flat(&[*position]), json!([name, text]))
        }
        _ => return None,
    };
    let style = &item.style;
    Some(json!({
        "kind": kind, "points": points, "more": more, "colour": style.colour.to_string(), "width": style.width,
        "opacity": style.opacity, "fill": style.fill, "dashed": style.dashed, "label": style.label,
        "from": rounded(item.from), "until": rounded(item.until),
    }))
}

fn flat(points: &[Point]) -> Vec<f64> {
    points.iter().flat_map(|point| [rounded(point.x), rounded(point.y)]).collect()
}

/// Rounded to a tenth of a millimetre, or of a millisecond.
fn rounded(number: f64) -> f64 {
    (number * 1e4).round() / 1e4
}
