//! A small paper of a study's manuscript, where LaTeX is on the PATH.

use crate::support::TempStudy;
use crate::where_there::{runs, trial};
use libtest_mimic::Trial;
use std::process::Command;

/// The test, with the program that it needs.
pub(crate) fn tests() -> Vec<Trial> {
    let latex = ["tectonic", "pdflatex"].into_iter().find(|program| runs(program).is_ok());
    let missing =
        latex.is_none().then(|| "neither tectonic nor pdflatex is on the PATH".to_owned());
    let name = "a_small_paper_compiles_with_the_numbers_methods_and_results_of_the_page";
    vec![trial(name, missing, move || compile(latex.unwrap()))]
}

fn compile(latex: &str) {
    let study = TempStudy::new();
    study.maveric(&["run", "pipelines/smoke.toml"]).ok();
    let manuscript = study.path("reports/smoke/manuscript");
    let numbers = std::fs::read_to_string(manuscript.join("numbers.tex")).unwrap();
    let lines = numbers.lines().filter_map(|line| line.strip_prefix("\\newcommand{\\"));
    let found = lines.filter_map(|rest| rest.split('}').next());
    // Every macro is used, the tables as they are, one figure as PDF.
    let used: Vec<String> = found.map(|name| format!("\\{name}{{}}\\par")).collect();
    let tables =
        ["descriptives", "contrasts", "bias"].map(|t| format!("\\input{{../tables/{t}.tex}}"));
    let paper = format!(
        "\\documentclass{{article}}\n\\usepackage[T1]{{fontenc}}\n\\usepackage{{booktabs,tabularx,textcomp,graphicx}}\n\\input{{numbers}}\n\\begin{{document}}\n\
         \\input{{methods}}\n\\input{{results}}\n{}\n\\includegraphics{{../figures/difference-panels.pdf}}\n{}\n\
         \\bibliographystyle{{plain}}\\bibliography{{references}}\n\\end{{document}}\n",
        tables.join("\n"),
        used.join("\n")
    );
    std::fs::write(manuscript.join("paper.tex"), paper).unwrap();
    let mut command = Command::new(latex);
    if latex == "pdflatex" {
        command.args(["-interaction=nonstopmode", "-halt-on-error"]);
    }
    let ran = command.arg("paper.tex").current_dir(&manuscript).output().unwrap();
    let said =
        String::from_utf8_lossy(&ran.stdout).into_owned() + &String::from_utf8_lossy(&ran.stderr);
    let end: String = said
        .lines()
        .rev()
        .take(30)
        .collect::<Vec<_>>()
        .into_iter()
        .rev()
        .collect::<Vec<_>>()
        .join("\n");
    assert!(ran.status.success(), "{latex}: {end}");
    assert!(!said.contains("Undefined control sequence"), "{end}");
    assert!(manuscript.join("paper.pdf").is_file());
}
