//! Reading a design: which of two rides was in the own style.

use super::{
    condition::Condition,
    error::{Checked, refuse},
    protocol::{Protocol, ProtocolStep},
    tested::known,
};

/// The scale whose one item asks it: 1 is the earlier of the two rides, 2 the later.
pub const WHICH: &str = "which";

const KEY: &str = "protocol.which";

/// Refuses to ask it of two rides that are not one in the own style and one in another, and without saying afterwards what was done.
pub(super) fn which(protocol: &Protocol, conditions: &[Condition]) -> Checked<()> {
    let Some(pair) = protocol.which else {
        return Ok(());
    };
    for id in pair {
        known(KEY, id, conditions)?;
    }
    let is_own = |c: &&Condition| pair.contains(&c.id) && c.in_own_style();
    let [first, second] = pair;
    if first == second || conditions.iter().filter(is_own).count() != 1 {
        return refuse(
            KEY,
            format!("`{first}` and `{second}`"),
            "two conditions, one of them with `car = { dial = 0 }`",
        );
    }
    let place = |step| protocol.steps.iter().position(|s| *s == step);
    let rides = place(ProtocolStep::Rides);
    if rides.is_none() || place(ProtocolStep::Which) < rides {
        let expected = "`which` among `steps`, after `rides`";
        return refuse(KEY, "nowhere to ask it", expected);
    }
    let elsewhere = [&protocol.before, &protocol.after, &protocol.post];
    if elsewhere.into_iter().flatten().any(|id| id == WHICH) {
        let expected = "it to be asked here alone: not in `before`, `after` or `post`";
        return refuse(KEY, "scale `which` twice", expected);
    }
    if protocol.debrief.is_none() {
        let expected = "a text that says afterwards what was done, such as \"debrief.md\": people were not told whose style it was";
        return refuse("protocol.debrief", "none", expected);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::Design;

    fn design(line: &str) -> Result<Design, String> {
        let text = format!(
            r#"
            [study]
            title = "Whose"
            [model]
            file = "model.maveric"
            [style]
            score = "adb.total"
            [baseline]
            id = "own"
            [[condition]]
            id = "mine"
            car = {{ dial = 0, recorded = true }}
            [[condition]]
            id = "mean"
            car = {{ mean = true, recorded = true }}
            [[condition]]
            id = "calm"
            car = {{ dial = -5, recorded = true }}
            [protocol]
            {line}
            "#
        );
        Design::from_toml(&text).map_err(|error| error.to_string())
    }

    #[test]
    fn one_of_the_two_is_the_own_style_and_a_debriefing_follows() {
        let debrief = "debrief = \"debrief.md\"\n";
        let asked = design(&format!("which = [\"mean\", \"mine\"]\n{debrief}")).unwrap();
        assert!(asked.protocol().which.is_some());
        for (line, told) in [
            ("which = [\"mean\", \"calm\"]", "dial = 0"),
            ("which = [\"mine\", \"mine\"]", "two conditions"),
            ("which = [\"mine\", \"men\"]", "men"),
            (
                "which = [\"mine\", \"mean\"]\nsteps = [\"drive\", \"which\", \"rides\"]",
                "after `rides`",
            ),
            ("which = [\"mine\", \"mean\"]\nsteps = [\"drive\", \"rides\"]", "after `rides`"),
            ("which = [\"mine\", \"mean\"]\nafter = [\"which\"]", "twice"),
        ] {
            let error = design(&format!("{line}\n{debrief}")).unwrap_err();
            assert!(error.contains(told), "{error}");
        }
        let error = design("which = [\"mine\", \"mean\"]").unwrap_err();
        assert!(error.contains("protocol.debrief"), "{error}");
    }
}
