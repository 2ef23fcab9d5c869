//! Every figure, as a file: well-formed, all texts inside, none on another, the same every time.

use crate::kinds;
use maveric_report::figures::embedding_space;
use maveric_report::{Context, Figure};
use resvg::usvg;
use std::sync::Arc;

fn tree(svg: &str) -> usvg::Tree {
    let mut options = usvg::Options::default();
    let mut fonts = usvg::fontdb::Database::new();
    for face in ["Regular", "Italic", "Semibold"] {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src/figures/font");
        fonts.load_font_data(std::fs::read(format!("{folder}/MavericSans-{face}.ttf")).unwrap());
    }
    options.fontdb = Arc::new(fonts);
    "Maveric Sans".clone_into(&mut options.font_family);
    usvg::Tree::from_str(svg, &options).unwrap()
}

fn texts(group: &usvg::Group, found: &mut Vec<(String, usvg::Rect)>) {
    for node in group.children() {
        match node {
            usvg::Node::Group(inner) => texts(inner, found),
            usvg::Node::Text(text) => {
                let words = text.chunks().iter().map(usvg::TextChunk::text).collect::<String>();
                found.push((words, text.abs_bounding_box()));
            }
            _ => {}
        }
    }
}

fn all() -> Vec<Figure> {
    let mut figures = kinds::figures(&kinds::context(7)).unwrap();
    figures.push(embedding_space(&kinds::embedding_space::input(), &Context::real()).unwrap());
    figures
}

#[test]
fn every_text_lies_inside_its_figure() {
    for figure in all() {
        let tree = tree(&figure.svg);
        let mut found = Vec::new();
        texts(tree.root(), &mut found);
        let size = tree.size();
        assert!(!found.is_empty(), "{}", figure.name);
        for (words, place) in found {
            let inside = place.left() >= -0.3
                && place.top() >= -0.3
                && place.right() <= size.width() + 0.3
                && place.bottom() <= size.height() + 0.3;
            assert!(inside, "{}: `{words}` at {place:?} in {size:?}", figure.name);
        }
    }
}

#[test]
fn no_text_lies_on_another() {
    // Boxes reach from ascent to descent: neighbours may share a third of their height.
    for figure in all() {
        let mut found = Vec::new();
        texts(tree(&figure.svg).root(), &mut found);
        for (index, (first, a)) in found.iter().enumerate() {
            for (second, b) in &found[index + 1..] {
                let wide = a.right().min(b.right()) - a.left().max(b.left());
                let tall = a.bottom().min(b.bottom()) - a.top().max(b.top());
                let least = a.height().min(b.height());
                let apart = wide <= 0.3 || tall <= 0.34 * least;
                assert!(apart, "{}: `{first}` and `{second}` collide", figure.name);
            }
        }
    }
}

#[test]
fn the_same_numbers_give_the_same_bytes() {
    let (first, second) = (all(), all());
    assert_eq!(first, second);
}

#[test]
fn what_shows_synthetic_participants_says_so_in_three_places() {
    for figure in kinds::figures(&kinds::context(7)).unwrap() {
        let explains = ["domain", "architecture"].contains(&figure.name.as_str());
        let says = [
            figure.caption.contains("Synthetic participants"),
            figure.svg.contains("<metadata>Synthetic participants; seed 7</metadata>"),
            figure.svg.contains(">synthetic participants</text>"),
        ];
        assert_eq!(says, [!explains; 3], "{}", figure.name);
    }
}

#[test]
fn every_figure_has_words_for_who_cannot_see_it_and_names_n_in_its_caption() {
    for figure in all() {
        assert!(figure.alt.len() > 20 && !figure.alt.contains('*'), "{}", figure.name);
        assert!(
            figure.caption.contains("*n* =")
                || figure.caption.contains("no data")
                || figure.caption.contains("epochs"),
            "{}",
            figure.name
        );
        assert!(figure.svg.contains("role=\"img\""));
        assert!(!figure.svg.contains("NaN") && !figure.svg.contains("\"inf"), "{}", figure.name);
    }
}

#[test]
fn png_is_300_dots_per_inch_and_says_what_it_shows() {
    let figures = all();
    let figure = figures.iter().find(|f| f.name == "domain").unwrap();
    let bytes = figure.png().unwrap();
    let decoder = png::Decoder::new(std::io::Cursor::new(&bytes));
    let reader = decoder.read_info().unwrap();
    let info = reader.info();
    assert_eq!(info.pixel_dims.unwrap().xppu, 11_811);
    assert_eq!(info.width, (120.0_f64 / 25.4 * 300.0).round() as u32);
    assert_eq!(info.utf8_text[0].get_text().unwrap(), figure.alt);
}

#[test]
fn a_file_on_its_own_carries_the_font() {
    let figure = &all()[0];
    assert!(!figure.svg.contains("@font-face"));
    let alone = figure.standalone_svg();
    assert_eq!(alone.matches("@font-face").count(), 3);
    tree(&alone);
}
