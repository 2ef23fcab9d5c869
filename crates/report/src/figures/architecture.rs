//! The five sub-networks, with the sizes of their actual layers.

use super::prelude::*;

/// Layer sizes, each list from the input to the output of one part.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Architecture {
    /// Size of the style embedding.
    pub embedding: usize,
    /// Time steps in the window that an encoder reads.
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
        ("layers of the following-distance predictor", &input.following_distance),
        ("layers of the lane-change encoder", &input.lane_encoder),
        ("layers of the lane-change predictor", &input.lane_change),
        ("layers of the speed encoder", &input.speed_encoder),
        ("layers of the velocity predictor", &input.velocity),
        ("layers of the style predictor", &input.style),
        ("layers of the mutual-information network", &input.mutual_information),
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
    layers.iter().map(ToString::to_string).collect::<Vec<_>>().join(" → ")
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
    let (left, top) = (place.left, place.top + 32.0);
    let height = (place.bottom - top) / 4.0;
    let row_y = |index: usize| top + (index as f64 + 0.5) * height;
    let bus = left + 184.0;
    let bus_pen = Pen::new(PURPLE, stroke::STRONG);
    let embedding = format!("style embedding *w*^{{(p)}}, {} numbers a driver", input.embedding);
    let look = Look::new(size::AXIS + 0.5).centred();
    let (from, base) = ((bus - 40.0, place.top), place.top + 19.0);
    panel(canvas, from, (from.0 + look.width(&embedding) + 14.0, base), PURPLE);
    let middle = (from.0 + 7.0, f64::midpoint(from.1, base));
    canvas.text(&embedding, middle, look);
    canvas.line((bus, base), (bus, row_y(3) - 5.0), bus_pen);
    for (index, row) in rows.iter().enumerate() {
        let y = row_y(index);
        canvas.arrow((bus, y - 5.0), (left + NETWORK.0, y - 5.0), bus_pen, 4.5);
        row.paint(canvas, (left, y));
    }
    let ends = (row_y(0) - BOX_HALF, row_y(3) + BOX_HALF);
    posterior(canvas, (left + POSTERIOR, place.right), ends, input);
}

/// From where to where the boxes reach, in points from the left, and half their height.
const ENCODER: (f64, f64) = (84.0, 158.0);
const NETWORK: (f64, f64) = (196.0, 310.0);
const OUTPUT: f64 = 352.0;
const POSTERIOR: f64 = 402.0;
const BOX_HALF: f64 = 14.0;

impl Row<'_> {
    /// Inputs, encoder, network, output and loss from left to right.
    fn paint(&self, canvas: &mut Canvas<'_>, (left, y): (f64, f64)) {
        let line = Pen::new(INK, stroke::BOX);
        let (output, low) = (left + OUTPUT, y + 5.0);
        let text = Look::new(size::AXIS).centred();
        let inputs = self.inputs.into_iter().filter(|line| !line.is_empty());
        let inputs: Vec<&str> = inputs.collect();
        let widest = text.widest(&inputs);
        for (k, words) in inputs.iter().enumerate() {
            let offset = (k as f64 - (inputs.len() as f64 - 1.0) / 2.0) * 11.0;
            canvas.text(words, (left, low + offset), text);
        }
        let mut from = left + widest + 3.0;
        if let Some((symbol, layers)) = self.encoder {
            canvas.arrow((from, low), (left + ENCODER.0, low), line, 4.5);
            let name = (format!("encoder, {symbol}"), size::AXIS);
            network(canvas, (left, low), ENCODER, (&name, layers), GREY);
            from = left + ENCODER.1;
        }
        if !inputs.is_empty() {
            canvas.arrow((from, low), (left + NETWORK.0, low), line, 4.5);
        }
        let name = (self.name.to_owned(), size::AXIS + 0.5);
        network(canvas, (left, y), NETWORK, (&name, self.layers), INK);
        canvas.arrow((left + NETWORK.1, y), (output - 10.0, y), line, 4.5);
        let title = Look::new(size::TITLE).middle().centred();
        canvas.text(self.output, (output, y), title);
        canvas.arrow((output + 12.0, y), (left + POSTERIOR, y), line, 4.5);
        let small = Look::new(size::TICK).middle().centred().colour(MUTED);
        canvas.text(self.loss, (output, y + 16.0), small);
    }
}

/// A box with a name and the sizes of its layers.
fn network(
    canvas: &mut Canvas<'_>,
    (left, y): (f64, f64),
    (from, to): (f64, f64),
    ((name, name_size), layers): (&(String, f64), &[usize]),
    edge: RGBColor,
) {
    panel(canvas, (left + from, y - BOX_HALF), (left + to, y + BOX_HALF), edge);
    let middle = left + f64::midpoint(from, to);
    let encoder = edge == GREY;
    let (name_y, sizes_y) = if encoder { (y - 4.0, y + 7.0) } else { (y - 3.0, y + 9.0) };
    canvas.text(name, (middle, name_y), Look::new(*name_size).middle());
    let small = Look::new(size::TICK).middle().colour(MUTED);
    canvas.text(&sizes(layers), (middle, sizes_y), small);
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
    canvas.text("*v*^{(lv)}, *z*^{(l)} and *z*^{(v)}", (middle, centre + 34.0), small);
    canvas.arrow((middle, base - 8.0), (middle, base + 8.0), Pen::new(INK, stroke::BOX), 4.5);
    canvas.text(
        "*ŵ*^{ (p)} ~ *N*(*μ*, *σ*)",
        (middle, base + 22.0),
        Look::new(size::TITLE).middle(),
    );
    canvas.text("*L*_{5}  squared error to *w*^{(p)}", (middle, base + 36.0), small);
}

/// A long list of sizes on two lines.
fn wrapped(layers: &[usize]) -> Vec<String> {
    if layers.len() <= 4 {
        return vec![sizes(layers)];
    }
    let half = layers.len().div_ceil(2);
    vec![format!("{} →", sizes(&layers[..half])), sizes(&layers[half..])]
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
        assert!(matches!(architecture(&input, &Context::real()), Err(ReportError::TooFew { .. })));
    }
}
