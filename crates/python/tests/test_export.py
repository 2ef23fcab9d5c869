"""An export is a Workflow Run RO-Crate that the public validator accepts, and names nobody."""

import importlib.metadata
import json
from pathlib import Path

import pytest

import maveric

validator = pytest.importorskip("rocrate_validator.services")
models = pytest.importorskip("rocrate_validator.models")
http = pytest.importorskip("rocrate_validator.utils.http")
jsonld = pytest.importorskip("rdflib.plugins.shared.jsonld.context")
requests = pytest.importorskip("requests")

CONTEXT = "https://w3id.org/ro/crate/1.1/context"


@pytest.fixture(autouse=True)
def no_network(monkeypatch):
    """The words of the standard from the package `rocrate`, so that the validator needs no network."""
    file = importlib.metadata.distribution("rocrate").locate_file("rocrate/data/ro-crate.jsonld")
    words = json.loads(Path(str(file)).read_text())
    # A later version of the standard moved this one.
    words["@context"]["ComputationalWorkflow"] = "https://bioschemas.org/ComputationalWorkflow"
    asked, read = http.HttpRequester.__getattr__, jsonld.source_to_json

    def answer(requester, name):
        real = asked(requester, name)

        def get(url, *args, **kwargs):
            if not str(url).startswith(CONTEXT):
                return real(url, *args, **kwargs)
            response = requests.Response()
            response.status_code, response.url = 200, str(url)
            response._content = json.dumps(words).encode()
            response.headers["Content-Type"] = "application/ld+json"
            return response

        return get if name == "get" else real

    def source(where, *args, **kwargs):
        return (words, None) if str(where).startswith(CONTEXT) else read(where, *args, **kwargs)

    monkeypatch.setattr(http.HttpRequester, "__getattr__", answer)
    monkeypatch.setattr(jsonld, "source_to_json", source)


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study") / "paper"
    maveric.command("init", str(folder), "--paper")
    maveric.run("pipelines/smoke.toml", "score", "ingest-study2", "--set", "duration=20", folder=folder)
    (folder / "key").write_text("a secret of this test alone")
    return folder


def export(study, out, *words):
    made = "study_data/generated/smoke"
    maveric.command(
        *("export", "--logs", f"{made}/logs/study2", "--participants", f"{made}/participants.csv"),
        *("--surveys", f"{made}/surveys.csv", "--key", "key", "--out", out, *words),
        folder=study,
    )
    return study / out


def problems(crate, profile):
    settings = validator.ValidationSettings(
        rocrate_uri=str(crate), profile_identifier=profile, requirement_severity=models.Severity.REQUIRED, offline=True
    )
    return [issue.message for issue in validator.validate(settings).get_issues()]


def test_an_export_with_its_run_is_a_workflow_run_crate(study):
    crate = export(study, "given", "--pipeline", "pipelines/smoke.toml", "--license", "https://creativecommons.org/licenses/by/4.0/")
    assert problems(crate, "workflow-run-crate-0.5") == []
    graph = json.loads((crate / "ro-crate-metadata.json").read_text())["@graph"]
    stages = {e["name"] for e in graph if e["@id"].startswith("#stage-")}
    assert {"Stage generate", "Stage score"} <= stages
    people = {line.split(",")[0] for line in (study / "study_data/generated/smoke/participants.csv").read_text().splitlines()[1:]}
    text = (crate / "ro-crate-metadata.json").read_text()
    assert people and not [person for person in people if f'{person}"' in text or f"{person}-" in text or f"{person}/" in text]


def test_an_export_without_a_run_is_a_process_run_crate(study):
    assert problems(export(study, "alone"), "process-run-crate-0.5") == []


def test_the_validator_finds_what_is_missing(study):
    crate = export(study, "broken")
    file = crate / "ro-crate-metadata.json"
    metadata = json.loads(file.read_text())
    del metadata["@graph"][1]["datePublished"]
    file.write_text(json.dumps(metadata))
    assert problems(crate, "process-run-crate-0.5")


def test_the_same_day_gives_the_same_bytes(study):
    both = [export(study, out, "--date", "2026-01-31") / "ro-crate-metadata.json" for out in ("one", "two")]
    assert both[0].read_bytes() == both[1].read_bytes()
