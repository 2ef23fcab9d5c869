//! `maveric seat`.

use super::{all_cores, print_as};
use crate::{
    diagnostics::{Failure, tell},
    interrupt, progress,
};
use maveric_seat::{Hindrance, Seat as Open, SeatError, SeatSettings, Wire, demo, files, replay};
use maveric_study::outcome::Format;
use maveric_study::{
    DesignFile, StudyError, check_design, design::DESIGN_FILE, run_folder, style_range,
};
use path_slash::PathExt as _;
use std::{
    net::SocketAddr,
    path::{Path, PathBuf},
    sync::Arc,
};

const OPENING: &str = "could not open the seat";
/// Where the environment may have the password of the experimenter's page.
const PASSWORD: &str = "MAVERIC_LAB_PASSWORD";
/// Where a study's folder keeps what the seat writes, and the file of its state there.
const RECORDS: &str = "seat";
const STATE: &str = "seat.db";

/// A driving study in a browser: a real person drives, is learned, and rides
#[derive(Debug, clap::Args)]
#[command(
    args_conflicts_with_subcommands = true,
    after_help = "\
Examples: maveric seat --demo             drive three minutes, ride in your own style, turn the dial
          maveric seat my_study           the study of that folder: links for people at /lab
          maveric seat forget P007 --study my_study
          maveric seat paid --study my_study
          maveric seat replay my_study/logs/seat/P001-own.mcap"
)]
pub(crate) struct Seat {
    #[command(subcommand)]
    part: Option<Part>,
    /// Folder of the study; the one you stand in when not given
    study: Option<PathBuf>,
    /// No study: a drive, your own model, a ride in your own style, a dial
    #[arg(long, conflicts_with_all = ["study", "password"])]
    demo: bool,
    /// Where to listen
    #[arg(long, default_value = "127.0.0.1:8437")]
    bind: SocketAddr,
    /// Certificate by which what is sent to other computers is encrypted, with its chain (PEM)
    #[arg(long, requires = "tls_key", conflicts_with = "plain_http")]
    tls_cert: Option<PathBuf>,
    /// Its private key (PEM)
    #[arg(long, requires = "tls_cert")]
    tls_key: Option<PathBuf>,
    /// Listen for other computers without encryption: a proxy in front encrypts
    #[arg(long)]
    plain_http: bool,
    /// Password of the experimenter's page; MAVERIC_LAB_PASSWORD of the environment, or made up and printed, when not given
    #[arg(long)]
    password: Option<String>,
    /// File that holds that password, in its first line; others who use this computer cannot read it as they can a command line
    #[arg(long, conflicts_with_all = ["password", "demo"])]
    password_file: Option<PathBuf>,
    /// Open no browser
    #[arg(long)]
    no_open: bool,
    /// Threads, for the model of the demonstration
    #[arg(short, long, default_value_t = all_cores())]
    jobs: usize,
}

#[derive(Debug, clap::Subcommand)]
enum Part {
    /// Delete all that a person gave, here and in the study's folder; an id is left, which nobody gets again
    Forget {
        /// Id of the person
        person: String,
        /// Folder of the study
        #[arg(long, default_value = ".")]
        study: PathBuf,
        /// How to print the result
        #[arg(long, value_enum, default_value_t)]
        format: Format,
    },
    /// Delete the ids on a platform of whoever is through, once they are paid
    Paid {
        /// Folder of the study
        #[arg(long, default_value = ".")]
        study: PathBuf,
        /// How to print the result
        #[arg(long, value_enum, default_value_t)]
        format: Format,
    },
    /// Drive a recorded drive again, and say whether it went through the same states to the byte
    Replay {
        /// The log of a drive in the seat, or its record (seat/PERSON-CONDITION.jsonl)
        log: PathBuf,
        /// How to print the result
        #[arg(long, value_enum, default_value_t)]
        format: Format,
    },
}

pub(super) fn failure(doing: &'static str) -> impl FnOnce(SeatError) -> Failure {
    move |cause| match cause {
        SeatError::Study(cause) => Failure::study(doing)(cause),
        cause => {
            let help = cause.suggestion();
            Failure::new(doing, cause, help)
        }
    }
}

impl Seat {
    pub(crate) fn run(self) -> Result<(), Failure> {
        match self.part {
            Some(Part::Replay { log, format }) => repeat(&log, format),
            Some(Part::Forget { person, study, format }) => forget(&study, &person, format),
            Some(Part::Paid { study, format }) => paid(&study, format),
            None if self.demo => self.demonstrate(),
            None => self.study(),
        }
    }

    fn demonstrate(&self) -> Result<(), Failure> {
        let cache = cache().ok_or_else(|| {
            Failure::Usage("no folder for the model: set XDG_CACHE_HOME".to_owned())
        })?;
        let settings = progress::watched(|watch| demo::settings(&cache, self.jobs, watch));
        let state = cache.join(format!("demo-{}.db", std::process::id()));
        let served = settings.map_err(failure(OPENING)).and_then(|settings| {
            let seat = Open::open(&state, settings).map_err(failure(OPENING))?;
            let token = seat.only_person().map_err(failure(OPENING))?;
            self.serve(seat, &format!("/p/{token}"), None)
        });
        for ending in ["", "-wal", "-shm", "-lock"] {
            let mut path = state.clone().into_os_string();
            path.push(ending);
            // What nobody looks at again; it may never have been there.
            let _ = std::fs::remove_file(path);
        }
        served
    }

    fn study(&self) -> Result<(), Failure> {
        let folder = self.study.clone().unwrap_or_else(|| PathBuf::from("."));
        let given = match (&self.password, &self.password_file) {
            (_, Some(file)) => Some(first_line(file)?),
            (Some(given), None) => Some(given.clone()),
            (None, None) => std::env::var(PASSWORD).ok(),
        };
        let made_up = match given {
            Some(_) => None,
            None => Some(maveric_seat::password().map_err(failure(OPENING))?),
        };
        let password = given.or_else(|| made_up.clone()).unwrap_or_default();
        let (seat, phase) = open(&folder, Some(password))?;
        if let Some(line) = phase {
            tell!("{line}");
        }
        for few in seat.few_donors().map_err(failure(OPENING))? {
            tell!("nobody new is let in: {}", few.with_remedy());
        }
        if let Some(over) = seat.withdrawal_over() {
            tell!("{over}");
        }
        self.serve(seat, "/lab", made_up.as_deref())
    }

    /// Serves until it is stopped; a password that was made up is printed, one that was given is known.
    fn serve(&self, seat: Open, page: &str, made_up: Option<&str>) -> Result<(), Failure> {
        interrupt::be_patient();
        let wire = match (&self.tls_cert, &self.tls_key) {
            (Some(certificate), Some(key)) => Wire::with_certificate(certificate, key),
            _ if self.plain_http => Ok(Wire::BehindProxy),
            _ => Ok(Wire::Here),
        };
        let wire = wire.map_err(failure(OPENING))?;
        let scheme = wire.scheme();
        let ready = |address: SocketAddr| {
            let url = format!("{scheme}://{address}{page}");
            tell!("the seat is open: {url}   (Ctrl-C ends it)");
            if let Some(password) = made_up {
                tell!("password of that page: {password}");
            }
            if !self.no_open {
                open_browser(&url);
            }
        };
        let stop = Arc::clone(interrupt::flag());
        let refused = |line: &str| tell!("{line}");
        maveric_seat::run(Arc::new(seat), (self.bind, wire), stop, ready, refused)
            .map_err(failure("could not serve the seat"))
    }
}

/// The first line of a file.
fn first_line(file: &Path) -> Result<String, Failure> {
    let text = std::fs::read_to_string(file).map_err(|e| {
        let doing = "could not read the password";
        Failure::io(doing, std::io::Error::new(e.kind(), format!("{}: {e}", file.to_slash_lossy())))
    })?;
    Ok(text.lines().next().unwrap_or_default().trim().to_owned())
}

/// Opens the seat of the study in `folder`, and says what is to be said of its phase.
fn open(folder: &Path, password: Option<String>) -> Result<(Open, Option<String>), Failure> {
    let study = DesignFile::read(&folder.join(DESIGN_FILE)).map_err(Failure::study(OPENING))?;
    let (settings, phase) = settings(&study, folder, password)?;
    let state = folder.join(RECORDS).join(STATE);
    let seat = Open::open(&state, settings).map_err(failure(OPENING))?;
    Ok((seat, phase))
}

/// What keeps the seat from opening this study, a line each; nothing where it could, where the design says nothing of a seat, or where
/// people drive elsewhere: there are logs, and the seat wrote none.
pub(super) fn hindrances(study: &DesignFile) -> Vec<String> {
    let folder = study.path.as_deref().and_then(Path::parent);
    let folder = folder.unwrap_or(Path::new(""));
    let logs = std::fs::read_dir(study.resolve(&study.design.files().logs));
    let is_log = |entry: std::io::Result<std::fs::DirEntry>| {
        entry.is_ok_and(|entry| !entry.file_name().as_encoded_bytes().starts_with(b"."))
    };
    let elsewhere = logs.is_ok_and(|mut logs| logs.any(is_log)) && !folder.join(RECORDS).is_dir();
    if elsewhere || !study.design.has_seat() {
        return Vec::new();
    }
    let settings = settings(study, folder, None);
    let hindrances =
        settings.and_then(|(settings, _)| settings.hindrances().map_err(failure(OPENING)));
    match hindrances {
        Ok(hindrances) => hindrances.iter().map(Hindrance::with_remedy).collect(),
        Err(failed) => vec![failed.in_a_line()],
    }
}

/// What the seat needs of the study in `folder`, and what is to be said of its phase.
fn settings(
    study: &DesignFile,
    folder: &Path,
    password: Option<String>,
) -> Result<(SeatSettings, Option<String>), Failure> {
    check_design(study).map_err(Failure::study(OPENING))?;
    let named = study.design.files();
    let (model, phase) = model(study, folder).map_err(Failure::study(OPENING))?;
    let bytes = model.as_deref().map(std::fs::read).transpose();
    let world = study.resolve(&named.scenario);
    let world = world.is_file().then_some(world);
    let (texts, in_others) = maveric_seat::files::texts(study).map_err(failure(OPENING))?;
    let range = style_range(study).map_err(Failure::study(OPENING))?;
    let settings = SeatSettings {
        scales: run_folder::read_scales(&study.resolve(&named.scales))
            .map_err(Failure::study(OPENING))?,
        texts,
        in_others,
        scenario: run_folder::read_seat_scenario(world.as_deref())
            .map_err(Failure::study(OPENING))?,
        model: bytes.map_err(|e| Failure::io(OPENING, e))?,
        made_up_model: study.design.synthetic() || study.design.model().is_some_and(|m| m.made_up),
        range,
        files: files::Files::of(study, folder.join(RECORDS)),
        password,
        design: study.design.clone(),
    };
    Ok((settings, phase))
}

fn forget(folder: &Path, person: &str, format: Format) -> Result<(), Failure> {
    let doing = "could not forget";
    let study = DesignFile::read(&folder.join(DESIGN_FILE)).map_err(Failure::study(doing))?;
    let state = folder.join(RECORDS).join(STATE);
    let gone = maveric_seat::forget(&study, &state, person).map_err(failure(doing))?;
    let mut lines = vec![format!("{} is forgotten", gone.participant)];
    if !gone.in_seat {
        lines.push("they had given nothing in the seat".to_owned());
    }
    if let Some(part) = &gone.study {
        lines.push(format!("{} files were removed", part.removed.len()));
        for (table, rows) in &part.rows {
            lines.push(format!("{}: {rows} rows were taken out", table.to_slash_lossy()));
        }
        for model in &part.models {
            let model = model.to_slash_lossy();
            lines.push(format!(
                "{model} had learned from them and was removed: `maveric run` learns it anew"
            ));
        }
        for file in &part.left {
            lines.push(format!("{} may name them still: look into it", file.to_slash_lossy()));
        }
    }
    lines.push(gone.lasting.to_owned());
    print_as(format, &gone, &lines)
}

fn paid(folder: &Path, format: Format) -> Result<(), Failure> {
    let doing = "could not delete whom the platform pays";
    let study = DesignFile::read(&folder.join(DESIGN_FILE)).map_err(Failure::study(doing))?;
    let state = folder.join(RECORDS).join(STATE);
    let paid = maveric_seat::paid(&study, &state).map_err(failure(doing))?;
    let line = format!(
        "{} ids on the platform were deleted; {} are left, of people whose part goes on",
        paid.deleted, paid.left
    );
    print_as(format, &paid, &[line])
}

fn repeat(log: &Path, format: Format) -> Result<(), Failure> {
    let doing = "could not drive it again";
    let repeated = replay::repeat(log).map_err(failure(doing))?;
    let word = match repeated.same {
        Some(true) => "the same states, to the byte",
        Some(false) => "other states than its record says",
        None => "cut short: nothing to hold its states against",
    };
    let line = format!(
        "{}, {} steps of 0.01 s, states {}: {word}",
        repeated.driven_by.as_str(),
        repeated.ticks,
        repeated.states
    );
    print_as(format, &repeated, &[line])?;
    Failure::told_unless(repeated.same != Some(false))
}

/// Where the runs of a study leave the model that they learned.
const LEARNED: &str = "results/model.maveric";

/// The model that rides in a study, and what is to be said of the study's phase: its own where it names none and people drive first
/// who are learned from.
fn model(
    study: &DesignFile,
    folder: &Path,
) -> Result<(Option<PathBuf>, Option<String>), StudyError> {
    let path = match study.design.model() {
        Some(named) => study.resolve(&named.file),
        None if study.design.people().learn.is_some() => folder.join(LEARNED),
        None => return Ok((None, None)),
    };
    if path.is_file() {
        maveric_study::forget::refuse_learned_from_gone(study, &path)?;
        run_folder::read_model(&path)?;
        let learned = study.design.model().is_none();
        let phase = format!("phase 2 of 2: people ride, by {}", path.to_slash_lossy());
        return Ok((Some(path), learned.then_some(phase)));
    }
    if study.design.model().is_some() {
        return Err(study.wrong(
            format!("`model.file`: found no file {}", path.to_slash_lossy()),
            Some("train it, or name another one".to_owned()),
        ));
    }
    let phase = format!(
        "phase 1 of 2: people drive who are learned from, nobody rides; when enough have, `maveric run train` in {} makes {LEARNED} of \
         them, and the seat is opened again",
        folder.to_slash_lossy()
    );
    Ok((None, Some(phase)))
}

/// Where a user's programs keep what can be made again.
fn cache() -> Option<PathBuf> {
    let folder = |name: &str| std::env::var_os(name).map(PathBuf::from);
    let cache = folder("XDG_CACHE_HOME").or_else(|| folder("LOCALAPPDATA"));
    let cache = cache.or_else(|| folder("HOME").map(|home| home.join(".cache")));
    cache.map(|cache| cache.join("maveric"))
}

/// Opens a page where that can be done; the address was printed in any case.
fn open_browser(url: &str) {
    let program = if cfg!(target_os = "macos") {
        "open"
    } else if cfg!(windows) {
        "explorer"
    } else {
        "xdg-open"
    };
    let quiet = std::process::Stdio::null;
    drop(std::process::Command::new(program).arg(url).stdout(quiet()).stderr(quiet()).spawn());
}
