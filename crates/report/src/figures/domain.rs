//! The domain: light traffic on two lanes, and what the model reads of it.

use super::prelude::*;
use super::theme::{LANE_LINE, ROAD};
use super::vehicle::paint_vehicle;

const LANE: f64 = 30.0;

/// Draws the road, the ego, the reference and an off-lane vehicle with the signals' names.
///
/// # Errors
/// [`ReportError::Drawing`] if the drawing library fails.
///
/// # Source
/// The paper's figure of the domain; method, section 2.
pub fn domain(context: &Context) -> Result<Figure, ReportError> {
    let plan = Plan {
        name: "domain".to_owned(),
        size_mm: (120.0, 39.5),
        title: "The domain of light traffic".to_owned(),
        caption: "Two lanes in one direction, seen from above, not to scale. *v*^{(ev)}: speed of \
                  the ego; *v*^{(lv)}: speed of the reference vehicle; *d*^{(x)}: from the ego’s \
                  front bumper to its rear bumper; *d*^{(y)}: lateral distance between the two. \
                  A drawing: no data."
            .to_owned(),
        alt: "A two-lane road. The ego, in the left lane, is about to pass the reference vehicle \
              ahead in the right lane; another vehicle is ahead in the left lane."
            .to_owned(),
        shows: Shows::Explanation,
    };
    draw(plan, context, |canvas, place| {
        let (left, right) = (place.left, place.right);
        let top = place.top + 16.0;
        road(canvas, (left, top), right);
        let upper = top + LANE / 2.0;
        let lower = top + 1.5 * LANE;
        let car = (46.0, 19.0);
        let point = |share: f64, y: f64| (left + share * (right - left), y);
        let (ego, lead, other) = (point(0.15, upper), point(0.57, lower), point(0.83, upper));
        paint_vehicle(canvas, ego, car, 0.0, PURPLE);
        paint_vehicle(canvas, lead, car, 0.0, GREY);
        paint_vehicle(canvas, other, car, 0.0, PAPER);
        let name = Look::new(size::TICK).middle();
        canvas.text("ego", (ego.0, top - 5.0), name);
        canvas.text("reference vehicle", (lead.0 + 4.0, top + 2.0 * LANE + 5.0), name.hanging());
        canvas.text("off-lane vehicle", (other.0, top - 5.0), name);
        let speed = Look::new(size::TITLE).centred();
        for (car_at, symbol) in [(ego, "*v*^{(ev)}"), (lead, "*v*^{(lv)}")] {
            let from = (car_at.0 + car.0 / 2.0 + 3.0, car_at.1);
            canvas.arrow(from, (from.0 + 26.0, from.1), Pen::new(INK, stroke::STRONG), 5.0);
            canvas.text(symbol, (from.0 + 29.0, from.1), speed);
        }
        let thin = Pen::new(MUTED, stroke::AXIS);
        let front = ego.0 + car.0 / 2.0;
        let rear = lead.0 - car.0 / 2.0;
        let below = top + 2.0 * LANE + 14.0;
        for x in [front, rear] {
            canvas.line(
                (x, if x < rear { ego.1 } else { lead.1 }),
                (x, below + 4.0),
                thin.dashed(1.5, 1.5),
            );
        }
        measure(canvas, (front, below), (rear, below));
        let middle = f64::midpoint(front, rear);
        let look = Look::new(size::TITLE).middle();
        canvas.text("*d*^{(x)}", (middle, below + 5.0 + cap_height(size::TITLE)), look);
        let beside = rear - 12.0;
        canvas.line((front + 62.0, ego.1), (beside + 4.0, ego.1), thin.dashed(1.5, 1.5));
        canvas.line((beside - 4.0, lead.1), (rear, lead.1), thin.dashed(1.5, 1.5));
        measure(canvas, (beside, ego.1), (beside, lead.1));
        canvas.text(
            "*d*^{(y)}",
            (beside - 4.0, f64::midpoint(ego.1, lead.1) + 8.0),
            Look::new(size::TITLE).end().centred(),
        );
    })
}

fn road(canvas: &mut Canvas<'_>, (left, top): (f64, f64), right: f64) {
    let bottom = top + 2.0 * LANE;
    canvas.fill_rect((left, top), (right, bottom), ROAD, 1.0);
    let edge = Pen::new(LANE_LINE, stroke::STRONG);
    canvas.line((left, top), (right, top), edge);
    canvas.line((left, bottom), (right, bottom), edge);
    canvas.line((left, top + LANE), (right, top + LANE), edge.dashed(9.0, 7.0));
}

fn measure(canvas: &mut Canvas<'_>, from: (f64, f64), to: (f64, f64)) {
    let middle = (f64::midpoint(from.0, to.0), f64::midpoint(from.1, to.1));
    let pen = Pen::new(INK, stroke::BOX);
    canvas.arrow(middle, from, pen, 4.0);
    canvas.arrow(middle, to, pen, 4.0);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_explanation_never_claims_participants() {
        let figure = domain(&Context::synthetic(1)).unwrap();
        assert!(!figure.svg.contains("ynthetic"));
    }
}
