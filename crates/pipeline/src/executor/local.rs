//! Stages as child processes on this machine.

use std::collections::VecDeque;
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, SyncSender};
use std::time::{Duration, Instant};

use wait4::{ResUse, Wait4 as _};

use super::{Ended, Job, group::Group, parent};

/// How often the flag is looked at.
const TICK: Duration = Duration::from_millis(25);
/// How long an interrupted child has to clear up before it is killed.
const GRACE: Duration = Duration::from_millis(75);
/// How long a killed child may take to die: only one that waits for a device takes longer.
const AFTER_KILL: Duration = Duration::from_secs(5);
/// How long a dead child's pipes, held open by children of its own, are still read.
const PIPES_AFTER_DEATH: Duration = Duration::from_millis(200);
const LONGEST_LINE: u64 = 64 * 1024;
const KEPT_STDOUT: usize = 256 * 1024;
const KEPT_LINES: usize = 20;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Stream {
    Stdout,
    Stderr,
}

/// What is heard of a running child.
enum Message {
    /// A line with its end.
    Line(Stream, Vec<u8>),
    /// One of its two streams has ended.
    StreamEnd,
    /// It is dead.
    Dead(std::io::Result<ResUse>),
}

/// Runs the job to its end, or until `stop` is set; `on_stderr` gets each line of standard
/// error as it comes.
///
/// # Errors
/// If the log cannot be written or the child cannot be waited for; it is killed then.
pub(crate) fn run(
    mut job: Job<'_>,
    stop: &AtomicBool,
    on_stderr: &mut dyn FnMut(String),
) -> std::io::Result<Ended> {
    let mut command = Command::new(job.program);
    command
        .args(job.arguments)
        .current_dir(job.root)
        .stdin(Stdio::from(job.stdin))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    Group::begin(&mut command);
    // The thread that starts it has to follow it to its end: the system asks a stage to end when that thread does.
    parent::tell(&mut command);
    let mut child = match command.spawn() {
        Ok(child) => child,
        Err(error) => return Ok(Ended::NotStarted(error)),
    };
    drop(command); // and with it our copy of the child's standard input
    let (sender, messages) = mpsc::sync_channel(256);
    if let Some(stdout) = child.stdout.take() {
        read_lines(stdout, Stream::Stdout, sender.clone());
    }
    if let Some(stderr) = child.stderr.take() {
        read_lines(stderr, Stream::Stderr, sender.clone());
    }
    let group = Group::new(&child);
    std::thread::spawn(move || {
        let _ = sender.send(Message::Dead(child.wait4()));
    });
    let mut kept = Kept::default();
    let until = job.limit.map(|limit| Instant::now() + limit);
    let followed = follow(&messages, stop, until, &mut |stream, line| {
        job.log.write_all(&line)?;
        let text = String::from_utf8_lossy(&line).into_owned();
        kept.add(stream, &text);
        if stream == Stream::Stderr {
            on_stderr(text.trim_end().to_owned());
        }
        Ok(())
    });
    let last_lines: Vec<String> = kept.last_lines.into();
    let ended = match followed {
        Ok(Followed::Dead(used)) => {
            return Ok(Ended::Exited {
                status: used.status,
                peak_memory: Some(used.rusage.maxrss).filter(|&bytes| bytes > 0),
                stdout: kept.stdout,
                last_lines,
            });
        }
        Ok(Followed::Stopped) => Ok(Ended::Interrupted),
        Ok(Followed::TooLong) => Ok(Ended::TimedOut { last_lines }),
        Err(error) => Err(error),
    };
    end(group, &messages);
    ended
}

/// Why a child is no longer followed.
enum Followed {
    Dead(ResUse),
    Stopped,
    TooLong,
}

/// Passes lines on until the child is dead and its pipes are read.
fn follow(
    messages: &Receiver<Message>,
    stop: &AtomicBool,
    until: Option<Instant>,
    on_line: &mut dyn FnMut(Stream, Vec<u8>) -> std::io::Result<()>,
) -> std::io::Result<Followed> {
    let mut open = 2;
    let mut dead: Option<(ResUse, Instant)> = None;
    loop {
        if stop.load(Ordering::Relaxed) {
            return Ok(Followed::Stopped);
        }
        if dead.is_none() && until.is_some_and(|until| Instant::now() > until) {
            return Ok(Followed::TooLong);
        }
        match messages.recv_timeout(TICK) {
            Ok(Message::Line(stream, line)) => on_line(stream, line)?,
            Ok(Message::StreamEnd) => open -= 1,
            Ok(Message::Dead(used)) => dead = Some((used?, Instant::now())),
            Err(RecvTimeoutError::Disconnected | RecvTimeoutError::Timeout) => {}
        }
        if let Some((used, since)) = dead
            && (open == 0 || since.elapsed() > PIPES_AFTER_DEATH)
        {
            return Ok(Followed::Dead(used));
        }
    }
}

fn read_lines(stream: impl Read + Send + 'static, name: Stream, sender: SyncSender<Message>) {
    std::thread::spawn(move || {
        let mut reader = BufReader::new(stream);
        loop {
            let mut line = Vec::new();
            match reader.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut line) {
                Ok(n) if n > 0 => {
                    if line.last() != Some(&b'\n') {
                        line.push(b'\n');
                    }
                    if sender.send(Message::Line(name, line)).is_err() {
                        return; // nobody follows any more
                    }
                }
                // An error of a pipe is its end for us; the exit status says the rest.
                _ => break,
            }
        }
        let _ = sender.send(Message::StreamEnd);
    });
}

/// Asks the child and all its children to end, kills what has not, and waits.
fn end(group: Group, messages: &Receiver<Message>) {
    group.ask_to_end();
    let died = has_died(messages, GRACE);
    group.kill();
    if !died {
        has_died(messages, AFTER_KILL);
    }
}

/// Drops what is still printed, so that nobody waits to be read.
fn has_died(messages: &Receiver<Message>, within: Duration) -> bool {
    let until = Instant::now() + within;
    loop {
        let left = until.saturating_duration_since(Instant::now());
        match messages.recv_timeout(left) {
            Ok(Message::Dead(_)) | Err(RecvTimeoutError::Disconnected) => return true,
            Err(RecvTimeoutError::Timeout) => return false,
            Ok(_) => {}
        }
    }
}

#[derive(Default)]
struct Kept {
    stdout: String,
    last_lines: VecDeque<String>,
}

impl Kept {
    fn add(&mut self, stream: Stream, line: &str) {
        if stream == Stream::Stdout {
            self.stdout.push_str(line);
            if self.stdout.len() > 2 * KEPT_STDOUT {
                let surplus = self.stdout.len() - KEPT_STDOUT;
                let bytes = self.stdout.as_bytes();
                let newline = bytes[surplus..].iter().position(|&b| b == b'\n');
                self.stdout.drain(..newline.map_or(surplus, |n| surplus + n + 1));
            }
        }
        if self.last_lines.len() == KEPT_LINES {
            self.last_lines.pop_front();
        }
        self.last_lines.push_back(line.trim_end().to_owned());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::File;
    use std::path::Path;

    fn shell(script: &str, stop: &AtomicBool) -> (Ended, String, Vec<String>) {
        shell_for(script, stop, None)
    }

    fn shell_for(
        script: &str,
        stop: &AtomicBool,
        limit: Option<Duration>,
    ) -> (Ended, String, Vec<String>) {
        let folder = tempfile::tempdir().unwrap();
        let log = folder.path().join("log");
        let arguments = ["-c".to_owned(), script.to_owned()];
        let job = Job {
            program: Path::new("sh"),
            arguments: &arguments,
            root: folder.path(),
            stdin: File::open("/dev/null").unwrap(),
            limit,
            log: File::create(&log).unwrap(),
        };
        let mut stderr = Vec::new();
        let ended = run(job, stop, &mut |line| stderr.push(line)).unwrap();
        (ended, std::fs::read_to_string(log).unwrap(), stderr)
    }

    #[test]
    fn both_streams_are_logged_and_standard_error_is_passed_on() {
        let script = "echo out; echo err >&2; printf unended; exit 3";
        let (ended, log, stderr) = shell(script, &AtomicBool::new(false));
        let Ended::Exited { status, peak_memory, stdout, last_lines } = ended else {
            panic!("it ends by itself");
        };
        #[cfg(target_os = "linux")]
        assert!(peak_memory.is_some_and(|bytes| bytes > 100_000));
        assert_eq!(status.code(), Some(3));
        assert_eq!(stdout, "out\nunended\n");
        assert_eq!(stderr, ["err"]);
        assert_eq!((log.lines().count(), last_lines.len()), (3, 3));
    }

    #[test]
    fn a_child_left_in_the_background_is_not_waited_for() {
        let (ended, ..) = shell("sleep 5 & exit 0", &AtomicBool::new(false));
        assert!(matches!(ended, Ended::Exited { status, .. } if status.success()));
    }

    #[test]
    fn a_child_that_runs_too_long_is_ended_with_what_it_had_said() {
        let limit = Some(Duration::from_millis(200));
        let script = "echo begun; sleep 600; echo over";
        let (ended, ..) = shell_for(script, &AtomicBool::new(false), limit);
        assert!(matches!(ended, Ended::TimedOut { last_lines } if last_lines == ["begun"]));
    }

    #[test]
    fn a_stopped_stage_takes_its_children_with_it() {
        let folder = tempfile::tempdir().unwrap();
        let late = folder.path().join("late");
        let script = format!("trap '' TERM; (sleep 0.6; echo x > {}) & wait", late.display());
        let stop = AtomicBool::new(false);
        let (ended, ..) = std::thread::scope(|scope| {
            let run = scope.spawn(|| shell(&script, &stop));
            std::thread::sleep(Duration::from_millis(150));
            stop.store(true, Ordering::Relaxed);
            run.join().unwrap()
        });
        assert!(matches!(ended, Ended::Interrupted));
        std::thread::sleep(Duration::from_millis(700));
        assert!(!late.exists());
    }
}
