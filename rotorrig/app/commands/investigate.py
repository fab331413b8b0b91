"""`rotor investigate`: sweep, track, diagnose, choose the next run; until the rig is understood or time is up."""

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from rotorrig.acquisition.files import open_recording, part_path, read_recording
from rotorrig.acquisition.sweep import plan_timeline
from rotorrig.app.commands import diagnose, sweep
from rotorrig.app.commands.config_model import criticals_to_pass
from rotorrig.app.commands.simulate import SimulatedRig, truth_of
from rotorrig.app.report import write_report
from rotorrig.app.terminal import confirm, out, progress_bars
from rotorrig.app.text import belief_text, proof_test_remark, run_text
from rotorrig.identify import Diagnosis, Verdict, read_diagnosis, write_diagnosis
from rotorrig.investigation import (
    Budget,
    Choice,
    Ending,
    Journal,
    Menu,
    Round,
    add_runs,
    beliefs,
    choose,
    not_possible,
    read_journal,
    write_journal,
)
from rotorrig.processing import OrderTrackedResponse, track
from rotorrig.processing.files import read_response, write_response
from rotorrig.rig import ConfigError, DataError, Provenance, RigError, code_version, write_whole_text
from rotorrig.rig.config import RigConfig, load
from rotorrig.sims.plant import seal

PATIENCE = "5 min"  # for each diagnosis: with its best so far, another run may tell more than more thought

JOURNAL, CONFIG, TRUTH, REPORT, EXTENDED = (
    "investigation.json",
    "rig.toml",
    "truth.sealed.json",
    "report.html",
    "extended.toml",
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Setup:
    """What an investigation runs on, and what it may do."""

    rig: RigConfig  # with the menu of runs among its plans
    menu: Menu
    folder: Path
    budget: Budget
    simulation: SimulatedRig | None = None
    unattended: bool = False  # nobody is asked for anything
    yes: bool = False  # requests to the operator do not wait
    seed: int = 0

    @property
    def hands(self) -> bool:
        """Whether a mass can be mounted: by the operator, or by the simulated rig."""
        return self.simulation is not None or not self.unattended

    @property
    def ramp(self) -> float:
        """Of the plan that was given [rad/s^2]; 0 of one without."""
        return float(getattr(self.rig.plans[self.menu.base], "ramp", 0.0))

    def file(self, name: str, number: int | None = None) -> Path:
        """Return the path of a file in the folder: "run.mcap" of run 2 is run-2.mcap."""
        stem, dot, ending = name.partition(".")
        return self.folder / (name if number is None else f"{stem}-{number}{dot}{ending}")

    def seconds_of(self, plan: str, speeds: tuple[float, ...]) -> float:
        """Return how long a plan takes, about, at these speeds [rad/s] if there are any."""
        return plan_timeline(sweep.steps_of(self.rig, plan, speeds=speeds))[-1].end


def prepare(
    rig: RigConfig,
    *,
    config: Path,
    folder: Path,
    plan: str,
    budget: Budget,
    simulation: SimulatedRig | None,
    unattended: bool = False,
    yes: bool = False,
    seed: int = 0,
) -> Setup:
    """Return an investigation that is ready to begin or to go on; its folder holds the config with the menu of runs.

    Raises ConfigError for a plan that may not be run, for an unattended rig whose protections are not proven, and for a
    folder of another config; DataError for one that cannot be made or holds other files.
    """
    remark = "" if simulation or not unattended else proof_test_remark(rig, config)
    if remark:
        raise ConfigError(f"--unattended: {remark}")
    with_menu, menu = add_runs(rig, plan)
    sweep.steps_of(with_menu, menu.base)
    setup = Setup(
        rig=with_menu,
        menu=_drop_forbidden(with_menu, menu),
        folder=folder,
        budget=budget,
        simulation=simulation,
        unattended=unattended,
        yes=yes,
        seed=seed,
    )
    _settle_folder(setup)
    if simulation and simulation.hidden is None:
        sealed = replace(simulation, hidden=setup.file(TRUTH))
        if not setup.file(TRUTH).exists():
            seal(truth_of(rig, simulation), setup.file(TRUTH))
        setup = replace(setup, simulation=sealed)
    return replace(setup, rig=load(setup.file(CONFIG)))


def investigate(setup: Setup) -> tuple[Journal, Diagnosis]:
    """Make runs until none follows; return the journal and the last diagnosis.

    Everything is in the folder as soon as it is known: killed at any moment, the same call goes on from there. Raises
    what a sweep, tracking and a diagnosis raise; a run that was tripped or interrupted is no part of the journal.
    """
    journal = _resume(setup)
    while True:
        last = journal.judged[-1] if journal.judged else None
        diagnosis = read_diagnosis(setup.file("diagnosis.json", last.number)) if last else None
        if len(journal.judged) == len(journal.rounds):
            wanted = choose(
                journal,
                diagnosis,
                menu=setup.menu,
                ramp=setup.ramp,
                budget=setup.budget,
                seconds_of=setup.seconds_of,
            )
            if isinstance(wanted, Ending):
                return _end(setup, journal, diagnosis, wanted)
            journal = _begin(setup, journal, wanted)
        if not setup.file("run.mcap", journal.rounds[-1].number).exists():
            journal = _run(setup, journal)
        journal = _judge(setup, journal)


def journal_facts(journal: Journal) -> dict[str, Any]:
    """Return an investigation as plain values, as they stand in its file."""
    return {"rounds": [asdict(each) for each in journal.rounds], "ending": journal.ending}


def _drop_forbidden(rig: RigConfig, menu: Menu) -> Menu:
    """Return the menu less what the rig's limits forbid; nothing is held where any speed may be a critical one's."""
    if criticals_to_pass(rig):
        menu = menu.without(menu.held)
    for name in menu.names:
        try:
            sweep.steps_of(rig, name)
        except ConfigError:
            menu = menu.without(name)
    return menu


def _settle_folder(setup: Setup) -> None:
    """Make the folder with the config in it, or make sure that it is the one there.

    Raises DataError for a folder that cannot be made or holds anything else, ConfigError for one of another config.
    """
    path = setup.file(CONFIG)
    try:
        setup.folder.mkdir(parents=True, exist_ok=True)
        strange = not path.exists() and any(setup.folder.iterdir())
    except OSError as error:
        raise DataError(f"{setup.folder}: cannot be a folder ({error.strerror}), want another --out") from error
    if strange:
        raise DataError(f"{setup.folder}: holds other files, want an empty folder, or one of an investigation")
    if not path.exists():
        write_whole_text(path, setup.rig.text)
    elif load(path).hash != setup.rig.hash:
        raise ConfigError(f"{path}: is another config than the one given, want another --out folder")


def _resume(setup: Setup) -> Journal:
    """Return the journal in the folder, less a run that was not finished; a new one where there is none."""
    path = setup.file(JOURNAL)
    if not path.exists():
        return Journal(config_hash=setup.rig.hash)
    journal = replace(read_journal(path), ending="")
    if journal.config_hash != setup.rig.hash:
        raise ConfigError(f"{path}: is of another config than {setup.file(CONFIG)}, want another --out folder")
    if journal.rounds and not setup.file("run.mcap", journal.rounds[-1].number).exists():
        journal = replace(journal, rounds=journal.rounds[:-1])
    out.print(f"Going on after {len(journal.judged)} runs.", highlight=False)
    mounted = "; ".join(journal.mounted) or "no trial mass"
    _ask(setup, f"Is the rotor at rest, and {mounted} on it?")
    return journal


def _begin(setup: Setup, journal: Journal, wanted: Choice) -> Journal:
    """Note a run that is about to be made, and have its masses mounted."""
    number = 1
    while any(setup.file(name, number).exists() for name in ("run.mcap", part_path(Path("run.mcap")).name)):
        number += 1
    out.rule(f"run {number}")
    out.print(wanted.why, highlight=False, markup=False, soft_wrap=True)
    off, on = set(journal.mounted) - set(wanted.trial), set(wanted.trial) - set(journal.mounted)
    todo = [*(f"take off '{mass}'" for mass in sorted(off)), *(f"mount '{mass}'" for mass in sorted(on))]
    if todo:
        _ask(setup, f"The rotor is at rest: {', then '.join(todo)}. Done?")
    elif not journal.rounds:
        _ask(setup, "The rotor will turn. Is it at rest, without a trial mass, and nobody near it?")
    asked = {key: getattr(wanted, key) for key in ("plan", "trial", "speeds", "why", "unseen")}
    begun = Round(number=number, **asked)
    return _keep(setup, replace(journal, rounds=(*journal.rounds, begun)))


def _run(setup: Setup, journal: Journal) -> Journal:
    """Make the last run of the journal. Raises RigError if it trips."""
    made = journal.rounds[-1]
    path = setup.file("run.mcap", made.number)
    simulation = setup.simulation
    if simulation:
        before = len(journal.rounds) - 1
        simulation = replace(simulation, seed=simulation.seed + before, before=before)
    try:
        result = sweep.sweep(
            setup.rig,
            out=path,
            plan=made.plan,
            trial=made.trial,
            speeds=made.speeds,
            simulation=simulation,
            view=False,
            yes=setup.yes,
        )
    except BaseException:
        _keep(setup, replace(journal, rounds=journal.rounds[:-1]))
        raise
    if result.trip:
        _keep(setup, replace(journal, rounds=journal.rounds[:-1]))
        raise RigError(f"{result.trip}; the rotor is at rest; {path} holds the run up to the trip")
    return _keep(setup, journal.with_last(seconds=result.seconds))


def _judge(setup: Setup, journal: Journal) -> Journal:
    """Track the last run and diagnose it with all before it.

    One that no fit is to see is held against what they say; if it does not bear that out, it joins them.
    """
    made = journal.rounds[-1]
    new = _track_once(setup, made)
    old = [read_response(setup.file("response.mcap", each.number)) for each in journal.judged]
    kinds = not_possible(setup.menu, hands=setup.hands)
    joined = False
    diagnosed = partial(diagnose.diagnose_responses, not_possible=kinds, seed=setup.seed, time_limit=PATIENCE)
    if made.unseen:
        diagnosis = diagnosed(old, holdout=new)
        joined = diagnosis.verdict is not Verdict.NAMED
    if joined or not made.unseen:
        diagnosis = diagnosed([*old, new])
    write_diagnosis(setup.file("diagnosis.json", made.number), diagnosis)
    judged = journal.with_last(
        seconds=made.seconds or float(new.t[-1]),
        joined=joined,
        verdict=diagnosis.verdict,
        sentence=diagnosis.sentence,
        beliefs=beliefs(diagnosis),
    )
    last = judged.rounds[-1]
    for words in (f"{run_text(last)}: {diagnosis.verdict}", belief_text(last.beliefs)):
        out.print(words, highlight=False, markup=False, soft_wrap=True)
    return _keep(setup, judged)


def _track_once(setup: Setup, made: Round) -> OrderTrackedResponse:
    """Return the response of a run, tracked if that was not done yet."""
    path = setup.file("response.mcap", made.number)
    if path.exists():
        return read_response(path)
    with progress_bars() as bars:
        task = bars.add_task("tracking", total=1.0, note="")
        show: Callable[[float], None] = lambda done: bars.update(task, completed=done)  # noqa: E731
        response = track(read_recording(setup.file("run.mcap", made.number)), progress=show)
    write_response(path, response)
    return response


def _end(setup: Setup, journal: Journal, diagnosis: Diagnosis | None, ending: Ending) -> tuple[Journal, Diagnosis]:
    """Note why no run follows; write the report and, of a named cause, the extended config."""
    if diagnosis is None:
        raise ConfigError(f"--budget: leaves no time for a first run of plan '{setup.menu.base}', want more")
    journal = _keep(setup, replace(journal, ending=ending.why))
    number = journal.judged[0].number
    first = read_response(setup.file("response.mcap", number))
    with open_recording(setup.file("run.mcap", number)) as recording:
        write_report(setup.file(REPORT), response=first, diagnosis=diagnosis, journal=journal, recording=recording)
    if diagnosis.verdict is Verdict.NAMED and diagnose.extend_rig(setup.rig, diagnosis) is not None:
        diagnose.write_extended(setup.file(EXTENDED), setup.rig, diagnosis)
    return journal, diagnosis


def _keep(setup: Setup, journal: Journal) -> Journal:
    source = Provenance(
        config_hash=setup.rig.hash,
        code_version=code_version(),
        source="simulated rig" if setup.simulation else setup.rig.name,
    )
    write_journal(setup.file(JOURNAL), journal, source)
    return journal


def _ask(setup: Setup, request: str) -> None:
    """Ask the operator; of a simulated rig, or with nobody there, nothing is asked."""
    if setup.simulation is None and not setup.unattended:
        confirm(request, yes=setup.yes)
