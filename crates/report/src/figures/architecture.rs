//! The five sub-networks, with the sizes of their actual layers.

use super::prelude::*;

/// Layer sizes, each list from the input to the output of one part.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Architecture {
    /// Size of the style embedding.
    pub embedding: usize,
    /// Steps in a window.
    pub window_steps: usize,
    /// The following-distance predictor.
    pub following_distance: Vec<usize>,
    /// Encoder of the lane-change predictor's windows.
    pub lane_encoder: Vec<usize>,
    /// The lane-change predictor after its encoder.
    pub lane_change: Vec<usize>,
    /// Encoder of the velocity predictor's windows.
    pub speed_encoder: Vec<usize>,
    /// The velocity predictor after its encoder.
    pub velocity: Vec<usize>,
    /// The style predictor.
    pub style: Vec<usize>,
    /// The mutual-information network.
    pub mutual_information: Vec<usize>,
}

const NAME: &str = "architecture";

/// Draws inputs, networks, outputs and losses.
///
/// # Errors
/// [`ReportError::TooFew`] if a part has fewer than two layers (input and output).
///
/// # Source
/// The paper's figure of the architecture; method, section 3.
pub fn architecture(input: &Architecture, context: &Context) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    let parts = [
        (
            "layers of the following-distance predictor",
            &input.following_distance,
        ),
        ("layers of the lane-change encoder", &input.lane_encoder),
        ("layers of the lane-change predictor", &input.lane_change),
        ("layers of the speed encoder", &input.speed_encoder),
        ("layers of the velocity predictor", &input.velocity),
        ("layers of the style predictor", &input.style),
        (
            "layers of the mutual-information network",
            &input.mutual_information,
        ),
    ];
    for (what, layers) in parts {
        check.at_least(2, what, layers.len())?;
    }
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (TWO_COLUMNS_MM, 98.0),
        title: "The network".to_owned(),
        caption: format!(
            "The five sub-networks with the sizes of their layers, from input to output; windows \
             have {} steps. The embedding *w*^{{(p)}} of each driver is learned together with the \
             weights; for a new driver it alone is fitted. ReLU between layers, softmax after \
             *C*_{{ψ}}, none in *S*_{{θ}}. A drawing: no data.",
            input.window_steps
        ),
        alt: format!(
            "The embedding of size {} goes into four predictors (following distance, lane change, \
             velocity, style); the mutual-information network reads their outputs and estimates \
             the embedding.",
            input.embedding
        ),
        shows: Shows::Explanation,
    };
    draw(plan, context, |canvas, place| paint(canvas, place, input))
}

struct Row<'a> {
    inputs: [&'a str; 2],
    encoder: Option<(&'a str, &'a [usize])>,
    name: &'a str,
    layers: &'a [usize],
    output: &'a str,
    loss: &'a str,
}

fn sizes(layers: &[usize]) -> String {
    layers
        .iter()
        .map(ToString::to_string)
        .collect::<Vec<_>>()
        .join(" → ")
}

fn paint(canvas: &mut Canvas<'_>, place: Place, input: &Architecture) {
    let rows = [
        Row {
            inputs: ["*v*^{(lv)} now", ""],
            encoder: None,
            name: "*F*_{φ}  following distance",
            layers: &input.following_distance,
            output: "*f̂*^{ (ev)}",
            loss: "*L*_{1}  squared error",
        },
        Row {
            inputs: ["windows of *v*^{(ev)},", "*v*^{(lv)}, *d*^{(x)}"],
            encoder: Some(("*z*^{(l)}", &input.lane_encoder)),
            name: "*C*_{ψ}  lane change",
            layers: &input.lane_change,
            output: "*l̂*^{ (ev)}",
            loss: "*L*_{2}  cross-entropy",
        },
        Row {
            inputs: ["windows of *v*^{(lv)},", "*d*^{(y)}, *d*^{(x)}"],
            encoder: Some(("*z*^{(v)}", &input.speed_encoder)),
            name: "*V*_{β}  velocity",
            layers: &input.velocity,
            output: "*v̂*^{ (ev)}",
            loss: "*L*_{3}  squared error",
        },
        Row {
            inputs: ["", ""],
            encoder: None,
            name: "*S*_{θ}  style score",
            layers: &input.style,
            output: "*ŝ*^{ (p)}",
            loss: "*L*_{4}  squared error",
        },
    ];
    let line = Pen::new(INK, stroke::BOX);
    let accent = PURPLE;
    let bus_pen = Pen::new(accent, stroke::STRONG);
    let (left, top) = (place.left, place.top + 32.0);
    let height = (place.bottom - top) / 4.0;
    let box_half = 14.0;
    let x_encoder = (left + 84.0, left + 158.0);
    let bus = left + 184.0;
    let x_network = (left + 196.0, left + 310.0);
    let x_output = left + 352.0;
    let x_posterior = (left + 402.0, place.right);
    let embedding = format!(
        "style embedding *w*^{{(p)}}, {} numbers a driver",
        input.embedding
    );
    let look = Look::new(size::AXIS + 0.5).centred();
    let wide = look.width(&embedding) + 14.0;
    let w_place = (
        (bus - 40.0, place.top),
        (bus - 40.0 + wide, place.top + 19.0),
    );
    panel(canvas, w_place.0, w_place.1, accent);
    canvas.text(
        &embedding,
        (w_place.0.0 + 7.0, f64::midpoint(w_place.0.1, w_place.1.1)),
        look,
    );
    let row_y = |index: usize| top + (index as f64 + 0.5) * height;
    canvas.line((bus, w_place.1.1), (bus, row_y(3) - 5.0), bus_pen);
    for (index, row) in rows.iter().enumerate() {
        let y = row_y(index);
        canvas.arrow((bus, y - 5.0), (x_network.0, y - 5.0), bus_pen, 4.5);
        let text = Look::new(size::AXIS).centred();
        let lines: Vec<&str> = row
            .inputs
            .into_iter()
            .filter(|line| !line.is_empty())
            .collect();
        let widest = lines
            .iter()
            .map(|line| text.width(line))
            .fold(0.0, f64::max);
        for (k, words) in lines.iter().enumerate() {
            let offset = (k as f64 - (lines.len() as f64 - 1.0) / 2.0) * 11.0;
            canvas.text(words, (left, y + 5.0 + offset), text);
        }
        if let Some((symbol, layers)) = row.encoder {
            canvas.arrow(
                (left + widest + 3.0, y + 5.0),
                (x_encoder.0, y + 5.0),
                line,
                4.5,
            );
            panel(
                canvas,
                (x_encoder.0, y - box_half + 5.0),
                (x_encoder.1, y + box_half + 5.0),
                GREY,
            );
            let middle = f64::midpoint(x_encoder.0, x_encoder.1);
            canvas.text(
                &format!("encoder, {symbol}"),
                (middle, y + 1.0),
                Look::new(size::AXIS).middle(),
            );
            canvas.text(
                &sizes(layers),
                (middle, y + 12.0),
                Look::new(size::TICK).middle().colour(MUTED),
            );
            canvas.arrow((x_encoder.1, y + 5.0), (x_network.0, y + 5.0), line, 4.5);
        } else if !lines.is_empty() {
            canvas.arrow(
                (left + widest + 3.0, y + 5.0),
                (x_network.0, y + 5.0),
                line,
                4.5,
            );
        }
        panel(
            canvas,
            (x_network.0, y - box_half),
            (x_network.1, y + box_half),
            INK,
        );
        let middle = f64::midpoint(x_network.0, x_network.1);
        canvas.text(
            row.name,
            (middle, y - 3.0),
            Look::new(size::AXIS + 0.5).middle(),
        );
        canvas.text(
            &sizes(row.layers),
            (middle, y + 9.0),
            Look::new(size::TICK).middle().colour(MUTED),
        );
        canvas.arrow((x_network.1, y), (x_output - 10.0, y), line, 4.5);
        canvas.text(
            row.output,
            (x_output, y),
            Look::new(size::TITLE).middle().centred(),
        );
        canvas.arrow((x_output + 12.0, y), (x_posterior.0, y), line, 4.5);
        canvas.text(
            row.loss,
            (x_output, y + 16.0),
            Look::new(size::TICK).middle().centred().colour(MUTED),
        );
    }
    posterior(
        canvas,
        x_posterior,
        (row_y(0) - box_half, row_y(3) + box_half),
        input,
    );
}

fn posterior(
    canvas: &mut Canvas<'_>,
    (left, right): (f64, f64),
    (top, bottom): (f64, f64),
    input: &Architecture,
) {
    let middle = f64::midpoint(left, right);
    let base = bottom - 44.0;
    panel(canvas, (left, top), (right, bottom), INK);
    let name = Look::new(size::AXIS + 0.5).middle();
    let small = Look::new(size::TICK).middle().colour(MUTED);
    let centre = f64::midpoint(top, base);
    canvas.text("*M*_{α}  mutual", (middle, centre - 24.0), name);
    canvas.text("information", (middle, centre - 14.0), name);
    for (index, line) in wrapped(&input.mutual_information).iter().enumerate() {
        canvas.text(line, (middle, centre - 2.0 + 10.0 * index as f64), small);
    }
    canvas.text("reads the four outputs,", (middle, centre + 24.0), small);
    canvas.text(
        "*v*^{(lv)}, *z*^{(l)} and *z*^{(v)}",
        (middle, centre + 34.0),
        small,
    );
    canvas.arrow(
        (middle, base - 8.0),
        (middle, base + 8.0),
        Pen::new(INK, stroke::BOX),
        4.5,
    );
    canvas.text(
        "*ŵ*^{ (p)} ~ *N*(*μ*, *σ*)",
        (middle, base + 22.0),
        Look::new(size::TITLE).middle(),
    );
    canvas.text(
        "*L*_{5}  squared error to *w*^{(p)}",
        (middle, base + 36.0),
        small,
    );
}

/// A long list of sizes on two lines.
fn wrapped(layers: &[usize]) -> Vec<String> {
    if layers.len() <= 4 {
        return vec![sizes(layers)];
    }
    let half = layers.len().div_ceil(2);
    vec![
        format!("{} →", sizes(&layers[..half])),
        sizes(&layers[half..]),
    ]
}

fn panel(canvas: &mut Canvas<'_>, from: (f64, f64), to: (f64, f64), edge: RGBColor) {
    canvas.fill_rect(from, to, if edge == GREY { PAPER } else { PALE }, 1.0);
    canvas.rect(from, to, Pen::new(edge, stroke::BOX));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_without_an_output_is_refused() {
        let input = Architecture {
            embedding: 3,
            window_steps: 20,
            following_distance: vec![4, 64, 64, 1],
            lane_encoder: vec![60, 16],
            lane_change: vec![19, 64, 64, 2],
            speed_encoder: vec![60, 16],
            velocity: vec![19],
            style: vec![3, 1],
            mutual_information: vec![37, 64, 64, 6],
        };
        assert!(matches!(
            architecture(&input, &Context::real()),
            Err(ReportError::TooFew { .. })
        ));
    }
}
