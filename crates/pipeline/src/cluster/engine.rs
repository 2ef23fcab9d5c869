//! What is asked of Slurm and HyperQueue, through their own programs.

use path_slash::PathExt as _;
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::{Executor, PipelineError, Resources};

/// Tasks that go to the cluster together: the stages of one fan-out that wait for as much.
pub(super) struct Group {
    /// What people see in the cluster's lists.
    pub(super) name: String,
    /// Numbers of the tasks, in a row.
    pub(super) tasks: std::ops::Range<u32>,
    pub(super) resources: Resources,
    /// How many times each is tried again.
    pub(super) retries: u32,
    /// Tasks of jobs that were handed in before, as the cluster calls the jobs.
    pub(super) after_jobs: BTreeSet<String>,
    /// For each task, those of this submission that it waits for; all have lower numbers.
    pub(super) after: Vec<BTreeSet<u32>>,
}

impl Group {
    /// The longest that a task may take with all its retries, in minutes.
    fn minutes(&self) -> Option<u32> {
        let minutes = self.resources.minutes?;
        Some(minutes.saturating_mul(self.retries.saturating_add(1)))
    }

    /// Whether each task waits for the task of the same place in `other`, and for no other of
    /// it.
    fn is_beside(&self, other: &std::ops::Range<u32>) -> bool {
        let pairs = self.after.iter().zip(other.clone());
        self.after.len() == other.len()
            && pairs.into_iter().all(|(after, partner)| {
                let mut inside = after.range(other.clone());
                inside.next() == Some(&partner) && inside.next().is_none()
            })
    }
}

/// Slurm's usual limit on an array is 1001 tasks.
pub(super) const LARGEST_GROUP: usize = 1000;

/// The engine as `--executor` names it.
pub(super) fn name(engine: Executor) -> &'static str {
    match engine {
        Executor::Local => "local",
        Executor::Slurm => "slurm",
        Executor::HyperQueue => "hq",
    }
}

/// Hands groups in; the job of each.
pub(super) fn submit(
    engine: Executor,
    pipeline: &str,
    groups: &[Group],
    at_once: Option<usize>,
    root: &Path,
    spool: &Path,
    accepted: &mut dyn FnMut(&Group, &str) -> Result<(), PipelineError>,
) -> Result<(), PipelineError> {
    if engine == Executor::HyperQueue {
        let job = submit_hq(pipeline, groups, root, spool)?;
        return groups.iter().try_for_each(|group| accepted(group, &job));
    }
    let mut jobs: Vec<(std::ops::Range<u32>, String)> = Vec::new();
    for group in groups {
        let mut after: BTreeSet<String> = BTreeSet::new();
        after.extend(group.after_jobs.iter().map(|job| format!("afterok:{job}")));
        for (tasks, job) in &jobs {
            // One by one where that is enough: the second step of the first need not wait for
            // the first step of the last.
            if group.is_beside(tasks) {
                after.insert(format!("aftercorr:{job}"));
            } else if group.after.iter().any(|a| a.range(tasks.clone()).next().is_some()) {
                after.insert(format!("afterok:{job}"));
            }
        }
        let job = sbatch(pipeline, group, &after, at_once, root, spool)?;
        accepted(group, &job)?;
        jobs.push((group.tasks.clone(), job));
    }
    Ok(())
}

fn sbatch(
    pipeline: &str,
    group: &Group,
    after: &BTreeSet<String>,
    at_once: Option<usize>,
    root: &Path,
    spool: &Path,
) -> Result<String, PipelineError> {
    // The array counts from 0, so that its limit bounds the group and not the plan.
    let first = group.tasks.start;
    let starter = spool.join(format!("{first}.array.sh"));
    let quoted = crate::shell::quoted([spool.to_string_lossy()]);
    let text = format!("#!/bin/sh\nexec /bin/sh {quoted}/$((SLURM_ARRAY_TASK_ID + {first})).sh\n");
    std::fs::write(&starter, text).map_err(PipelineError::io("write", &starter))?;
    let last = group.tasks.len() - 1;
    let limit = at_once.map_or_else(String::new, |jobs| format!("%{jobs}"));
    let mut command = Command::new("sbatch");
    command
        .args(["--parsable", "--requeue", "--kill-on-invalid-dep=yes"])
        .arg(format!("--array=0-{last}{limit}"))
        .arg(format!("--job-name={pipeline}.{}", group.name))
        .arg(format!("--chdir={}", root.to_slash_lossy()))
        .arg(format!("--output={}/%A_%a.slurm", spool.to_slash_lossy()));
    if !after.is_empty() {
        let after: Vec<&str> = after.iter().map(String::as_str).collect();
        command.arg(format!("--dependency={}", after.join(",")));
    }
    if let Some(cpus) = group.resources.cpus {
        command.arg(format!("--cpus-per-task={cpus}"));
    }
    if let Some(memory) = group.resources.memory_mb {
        command.arg(format!("--mem={memory}M"));
    }
    if let Some(minutes) = group.minutes() {
        command.arg(format!("--time={minutes}"));
    }
    let printed = output(command.arg(&starter))?;
    // `ID`, or `ID;CLUSTER` where there are several.
    let job = printed.trim().split(';').next().unwrap_or_default();
    if job.is_empty() || !job.bytes().all(|byte| byte.is_ascii_digit()) {
        return Err(PipelineError::Engine {
            command: "sbatch".to_owned(),
            message: format!("it printed `{}` where a job's number was expected", printed.trim()),
        });
    }
    Ok(job.to_owned())
}

fn submit_hq(
    pipeline: &str,
    groups: &[Group],
    root: &Path,
    spool: &Path,
) -> Result<String, PipelineError> {
    let plan = spool.join("plan.toml");
    let text = hq_plan(pipeline, groups, root, spool);
    std::fs::write(&plan, text).map_err(PipelineError::io("write", &plan))?;
    let mut command = Command::new("hq");
    command.args(["--output-mode", "json", "job", "submit-file"]);
    let printed = output(command.arg(&plan))?;
    let id = serde_json::from_str::<Value>(&printed);
    let id = id.ok().and_then(|answer| answer["id"].as_u64());
    id.map(|id| id.to_string()).ok_or_else(|| PipelineError::Engine {
        command: "hq job submit-file".to_owned(),
        message: format!("it printed `{}` where {{\"id\": NUMBER}} was expected", printed.trim()),
    })
}

/// HyperQueue's job file.
fn hq_plan(pipeline: &str, groups: &[Group], root: &Path, spool: &Path) -> String {
    let text = |path: &Path| toml::Value::String(path.to_slash_lossy().into_owned()).to_string();
    let mut plan = format!("name = {}\n", toml::Value::String(pipeline.to_owned()));
    for group in groups {
        for (task, deps) in group.tasks.clone().zip(&group.after) {
            let deps: Vec<u32> = deps.iter().copied().collect();
            let script = text(&super::script::script(spool, task));
            let cpus = group.resources.cpus.unwrap_or(1);
            let _ = write!(
                plan,
                "\n[[task]]\nid = {task}\ncommand = [\"/bin/sh\", {script}]\ndeps = {deps:?}\n\
                 cwd = {}\nstdout = \"none\"\nstderr = \"none\"\n",
                text(root)
            );
            if let Some(minutes) = group.minutes() {
                let _ = writeln!(plan, "time_limit = \"{minutes}m\"");
            }
            let memory = group.resources.memory_mb;
            let memory = memory.map_or_else(String::new, |mib| format!(", mem = {mib}"));
            let request = format!("[[task.request]]\nresources = {{ cpus = {cpus}{memory} }}");
            let _ = writeln!(plan, "{request}");
        }
    }
    plan
}

/// Of the jobs, the tasks that wait or run, as `JOB_NUMBER`; the number counts from 0 in
/// each array of Slurm and is the plan's for HyperQueue.
pub(super) fn alive(
    engine: Executor,
    jobs: &BTreeSet<String>,
) -> Result<BTreeSet<String>, PipelineError> {
    if engine != Executor::HyperQueue {
        let printed = output(Command::new("squeue").args(["--me", "-h", "-r", "-o", "%i %t"]))?;
        let alive = |line: &str| {
            let (id, state) = line.trim().split_once(' ')?;
            // Ended, and only cleared away now.
            (!["CD", "F", "CA", "TO", "NF", "OOM"].contains(&state)).then(|| id.to_owned())
        };
        return Ok(printed.lines().filter_map(alive).collect());
    }
    let mut alive = BTreeSet::new();
    for job in jobs {
        let answer = job_info_hq(job)?;
        let tasks = answer[0]["tasks"].as_array().into_iter().flatten();
        for task in tasks {
            let waits = matches!(task["state"].as_str(), Some("waiting" | "running"));
            if let (true, Some(id)) = (waits, task["id"].as_u64()) {
                alive.insert(format!("{job}_{id}"));
            }
        }
    }
    Ok(alive)
}

/// What the engine says of a task that has ended without its own word.
pub(super) fn last_state(engine: Executor, task: &str) -> String {
    let unknown = || "the cluster no longer knows it".to_owned();
    if engine != Executor::Slurm {
        return task
            .split_once('_')
            .and_then(|(job, number)| last_state_hq(job, number))
            .unwrap_or_else(unknown);
    }
    // Where accounting is not kept, the controller still knows a job for some minutes.
    let text_of =
        |program: &str, arguments: &[&str]| output(Command::new(program).args(arguments)).ok();
    let accounted = text_of("sacct", &["-n", "-X", "-P", "-o", "State", "-j", task]);
    let accounted = accounted.and_then(|text| text.lines().next().map(|s| s.trim().to_owned()));
    // Accounting hears of an end late: until then it has the state before.
    let accounted = accounted.filter(|state| is_final(state));
    let controlled = || {
        let text = text_of("scontrol", &["-o", "show", "job", task])?;
        let state = text.split_whitespace().find_map(|word| word.strip_prefix("JobState="))?;
        Some(state.to_owned())
    };
    let controlled = || controlled().filter(|state| is_final(state));
    accounted.or_else(controlled).unwrap_or_else(unknown)
}

/// Whether a state of Slurm is one in which jobs end; it may go on, as `CANCELLED by 1000`.
fn is_final(state: &str) -> bool {
    let word = state.split([' ', '+']).next().unwrap_or_default();
    matches!(
        word,
        "BOOT_FAIL"
            | "CANCELLED"
            | "COMPLETED"
            | "DEADLINE"
            | "FAILED"
            | "NODE_FAIL"
            | "OUT_OF_MEMORY"
            | "PREEMPTED"
            | "REVOKED"
            | "TIMEOUT"
    )
}

/// What HyperQueue says of a job.
fn job_info_hq(job: &str) -> Result<Value, PipelineError> {
    let mut command = Command::new("hq");
    let printed = output(command.args(["--output-mode", "json", "job", "info", job]))?;
    serde_json::from_str(&printed).map_err(|e| PipelineError::Engine {
        command: "hq job info".to_owned(),
        message: e.to_string(),
    })
}

/// State and error of a task as HyperQueue has them.
fn last_state_hq(job: &str, number: &str) -> Option<String> {
    let answer = job_info_hq(job).ok()?;
    let mut tasks = answer[0]["tasks"].as_array()?.iter();
    let task = tasks.find(|task| task["id"].as_u64().is_some_and(|id| id.to_string() == number))?;
    let state = task["state"].as_str()?;
    Some(match task["error"].as_str() {
        Some(error) => format!("{state}: {}", error.trim()),
        None => state.to_owned(),
    })
}

/// Takes jobs back; that one has ended meanwhile is no error.
pub(super) fn cancel(engine: Executor, jobs: &BTreeSet<String>) {
    for job in jobs {
        let _ = match engine {
            Executor::HyperQueue => output(Command::new("hq").args(["job", "cancel", job])),
            _ => output(Command::new("scancel").arg(job)),
        };
    }
}

fn output(command: &mut Command) -> Result<String, PipelineError> {
    let program = command.get_program().to_string_lossy().into_owned();
    let failed = |message: String| PipelineError::Engine { command: program.clone(), message };
    crate::executor::set_apart(command);
    let output = command.output().map_err(|error| failed(error.to_string()))?;
    if !output.status.success() {
        let message = String::from_utf8_lossy(&output.stderr).trim().to_owned();
        return Err(failed(format!("{} ({})", message, output.status)));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plan_for_hyperqueue_is_toml_with_the_order_of_the_tasks() {
        let group = |name: &str, tasks, after: &[u32]| Group {
            name: name.to_owned(),
            tasks,
            resources: Resources { cpus: Some(2), memory_mb: Some(300), minutes: Some(5) },
            retries: 1,
            after_jobs: BTreeSet::new(),
            after: vec![after.iter().copied().collect(); 2],
        };
        let groups = [group("a", 0..2, &[]), group("b", 2..3, &[0, 1])];
        let plan = hq_plan("p", &groups, "/r".as_ref(), "/s \"x".as_ref());
        let plan: toml::Value = toml::from_str(&plan).unwrap();
        let tasks = plan["task"].as_array().unwrap();
        assert_eq!(tasks.len(), 3);
        assert_eq!(tasks[2]["deps"].as_array().unwrap().len(), 2);
        assert_eq!(tasks[1]["command"][1].as_str(), Some("/s \"x/1.sh"));
        assert_eq!(tasks[0]["time_limit"].as_str(), Some("10m"));
        let resources = &tasks[0]["request"][0]["resources"];
        assert_eq!(resources["mem"].as_integer(), Some(300));
        assert_eq!(tasks[0]["request"][0]["resources"]["cpus"].as_integer(), Some(2));
    }

    #[test]
    fn only_a_state_in_which_jobs_end_says_how_one_ended() {
        for state in ["TIMEOUT", "CANCELLED by 1000", "OUT_OF_MEMORY", "FAILED"] {
            assert!(is_final(state), "{state}");
        }
        for state in ["", "RUNNING", "PENDING", "COMPLETING", "REQUEUED"] {
            assert!(!is_final(state), "{state}");
        }
    }

    #[test]
    fn tasks_that_wait_for_their_namesakes_alone_are_beside_them() {
        let group = |after: &[&[u32]]| Group {
            name: "g".to_owned(),
            tasks: 10..12,
            resources: Resources::default(),
            retries: 0,
            after_jobs: BTreeSet::new(),
            after: after.iter().map(|a| a.iter().copied().collect()).collect(),
        };
        assert!(group(&[&[4], &[5]]).is_beside(&(4..6)));
        assert!(group(&[&[1, 4], &[5]]).is_beside(&(4..6)));
        assert!(!group(&[&[4], &[5]]).is_beside(&(4..7)));
        assert!(!group(&[&[5], &[4]]).is_beside(&(4..6)));
        assert!(!group(&[&[4, 5], &[5]]).is_beside(&(4..6)));
    }
}
