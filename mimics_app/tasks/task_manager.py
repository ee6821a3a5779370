"""The task manager of D2.1 Figure 1: from the person's input and the robot's state to the orders of the renderers.

One `step` per frame. Time is given as `now_ns`, random numbers come from the seed, so that a replay gives the same
trials.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from msgspec import structs
from numpy.typing import NDArray

from mimics_app.contracts.messages.action_space import Parameter
from mimics_app.contracts.messages.board import Board
from mimics_app.contracts.messages.orders import TRIAL, Feature, HapticField, HapticOrder, Numbers, VisualOrder, shown
from mimics_app.contracts.messages.stage_messages import (
    GAIN,
    AudioOrder,
    HapticSnapshot,
    SoundEvent,
    SoundTrigger,
    TactileEvent,
    TactileOrder,
    TaskAction,
    TaskOrders,
    TrialResult,
    VRInput,
)
from mimics_app.contracts.messages.trial_counts import ABORTED, FINISHED, SESSION_ENDED
from mimics_app.contracts.messages.trial_state import TaskView, TrialState
from mimics_app.contracts.ports.display_port import FrameTiming
from mimics_app.contracts.ports.scenario_port import Home, TaskContext
from mimics_app.tasks.actions import Changes, Settings, build_action_space, settings_for
from mimics_app.tasks.adaptation import Adaptation
from mimics_app.tasks.attempts import TIMEOUT, Attempts, PlayedKinds, Row
from mimics_app.tasks.board_layout import BoardLayout, Times
from mimics_app.tasks.control import Approach, Arrival, RobotControl
from mimics_app.tasks.countdown import Countdown
from mimics_app.tasks.goals import Goals
from mimics_app.tasks.kinds.kind import TaskKind
from mimics_app.tasks.kinds.registry import play_of, task_kinds
from mimics_app.tasks.observation import Observation, observe
from mimics_app.tasks.outcome_words import what_happened
from mimics_app.tasks.prompt import ABORTED_CAUSES, Announcement, built_in_messages, cause_words
from mimics_app.tasks.state_machine import PAUSED, Conditions, Pause, TrialTimes, next_state
from mimics_app.tasks.steering import Steering
from mimics_app.tasks.task import ActionDeed, Deed, MessageDeed, ScoreSpec, SoundDeed, TaskSpec
from mimics_app.tasks.trials import Trial, check_first_trial, plan_trials, trial_blocks
from mimics_app.tasks.triggers import Moment, Triggers

__all__ = ["TaskManager"]


_SET_OUT_J = 0.005
"""Work of the person on the handle from which the hand has set out by itself [J]: a mass of 3 kg at 6 cm/s. The work
of a passive hand is never above zero, and the noise of a force sensor sums up to a tenth of this."""
_RISE_S = 0.5
"""Time in which the assistance rises from nothing to all of it [s]."""
_LEADING = "advance"
"""Name of haptic fields of tunnels whose force leads the hand along a path by itself."""


def _leads(number: HapticField) -> bool:
    return number.field == _LEADING and bool(number.table)


class Participation:
    """Follows the person through the travel of a trial.

    Assistance that leads the hand to the goal begins when the hand has set out by itself; so it helps those who move
    and carries nobody. In a passive task it begins at the go.

    Args:
        passive: Whether the task is meant to be done without any action of the person.

    Attributes:
        acted: Whether the person has taken part in the travel so far; always in a passive task.
    """

    def __init__(self, *, passive: bool) -> None:
        self._passive = passive
        self.restart()

    def restart(self) -> None:
        """Begin an attempt: nobody has acted, and nothing assists."""
        self.acted = self._passive
        self._share = 0.0

    def see(self, seen: Observation, seconds: float) -> None:
        """Take a frame of the travel with its duration [s]."""
        self.acted = self.acted or seen.own_work >= _SET_OUT_J
        if self.acted:
            self._share = min(1.0, self._share + seconds / _RISE_S)

    def allow(self, haptic: Mapping[HapticField, Numbers]) -> dict[HapticField, Numbers]:
        """Return haptic orders with the present share of those that lead the hand."""
        return {
            field: self._share * value if _leads(field) and isinstance(value, int | float) else value
            for field, value in haptic.items()
        }


def _ignore(*_: object) -> None:
    """Do nothing."""


class TaskManager:
    """One session of a task.

    Args:
        spec: The scene's task; its trial file, if it names one, has been read (`tasks.trial_file.resolve_trials`).
        context: Data of the scene.
        seed: Seed of the session; determines the order of the trials.
        on_trial: Called with the row of each attempt at its end (columns: `tasks.attempts.Row`).
        on_event: Called with a kind ("state", "action", "clipped", "session_end") and its data, for the journal.
        first_trial: Trial to begin with, 0 first; those before it are left out.
        features: What the scenario can show; maps of the scene's parameters name them.

    Attributes:
        state: State of the current trial.

    Raises:
        UsageError: The session has no such trial.
    """

    def __init__(
        self,
        spec: TaskSpec,
        context: TaskContext,
        seed: int,
        on_trial: Callable[[Row], None] = _ignore,
        on_event: Callable[[str, Mapping[str, object]], None] = _ignore,
        first_trial: int = 0,
        features: Iterable[Feature[Any]] = (),
    ) -> None:
        self._spec = spec
        self._features = {feature.name: feature for feature in features}
        self._on_event = on_event
        self._space = build_action_space(spec)
        self._adaptation = Adaptation(self._space)
        plan = plan_trials(trial_blocks(spec), seed)
        check_first_trial(first_trial + 1, len(plan))
        kinds = [kind for kind in task_kinds() if kind.takes(spec, context.offers)]
        self._plays = {kind.name: kind.open(spec, context, seed) for kind in kinds}
        counts = [kind.completes for kind in kinds if kind.completes]
        has_score = any(kind.scored for kind in kinds) or spec.score != ScoreSpec()  # own weights
        score = spec.score if has_score else None
        plays = tuple(self._plays.values())
        led = any(play.led for play in plays)
        self._participation, self._limb = Participation(passive=spec.passive or led), context.limb
        self._times = TrialTimes(spec)
        played = PlayedKinds(plays, counts, self._tell, all(kind.touches for kind in kinds))
        self._attempts = Attempts(plan, score, spec.start.attempts, on_trial, played, first_trial)
        self._bodies = context.bodies
        self._fastest, self._least_s = context.fastest, 0.0
        self._control = RobotControl(context.home or Home(context.start_joints))
        arrival = Arrival(spec.start, context.start_joints)
        self._approach = Approach(0.0 if context.simulated else spec.start.announce_s, arrival, self._control)
        self._goals = Goals(spec.goals, [play_of(goal, self._plays) for goal in spec.goals])
        self._triggers = Triggers(spec.triggers, [play_of(trigger.when, self._plays) for trigger in spec.triggers])
        self._announcement, self._pause = Announcement(), Pause()
        self._countdown = Countdown(spec.start.countdown_s, introduced=context.introduced, waits=context.waits)
        self._seen: Observation | None = None
        self._haptic, self._visual = Changes[HapticField, Numbers](), Changes[Feature[Any], Any]()
        self._audio = Changes[str, object]()
        self._settings, self._settings_values = Settings(), dict[str, float]()
        messages = {**built_in_messages(by_pointer=context.by_pointer), **spec.messages}
        captions = kinds[-1] if kinds else TaskKind
        mark = (0.0, 0.0) if context.by_pointer and self.lever and not spec.passive else None
        self._layout = BoardLayout(
            plays, captions, messages, context.limb, has_score=has_score, neutral=mark, prompt=spec.prompt
        )
        self.state = TrialState.APPROACH
        self._entered_ns: int | None = None
        self._last_ns = 0
        self._cause = 0
        self._result: TrialResult | None = None
        self._steering = Steering(self._space, self._adaptation, self._attempts, self._pause, self._countdown)

    @property
    def values(self) -> Mapping[str, float]:
        """Present values of the adaptable parameters, each in its unit."""
        return dict(self._adaptation.values)

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The adaptable parameters."""
        return tuple(self._space)

    @property
    def plan(self) -> tuple[Trial, ...]:
        """The trials of the session in order."""
        return self._attempts.plan

    @property
    def lever(self) -> bool:
        """Whether the hand is a lever, whose deflection from the start counts, and not its place."""
        return any(play.lever for play in self._plays.values())

    @property
    def rows(self) -> tuple[Row, ...]:
        """Rows of the attempts so far."""
        return tuple(self._attempts.rows)

    @property
    def done(self) -> bool:
        """True when the last trial is over."""
        return self.state is TrialState.DONE

    def step(
        self,
        vr: VRInput,
        action: TaskAction | None,
        snapshot: HapticSnapshot,
        events: NDArray[Any],
        now_ns: int,
        timing: FrameTiming | None = None,
    ) -> TaskOrders:
        """Process one frame: `events` are the EVENT records since the last one, shape [n]; `now_ns` never decreases."""
        seen = observe(snapshot, events, now_ns, self._bodies, vr.pressed, timing, vr.head)
        self._steering.take(vr.commands, self.state, begun=self._seen is not None)
        if action is not None:
            self._take(action, now_ns)
        self._result = None
        if self._pauses(seen):
            return self._orders(self._hold(now_ns), ())
        for play in self._plays.values():
            seen = play.see(seen, self._settings.task)
        self._seen = seen
        left, entered = self._advance(seen)
        moment = Moment(self.state, entered, left, vr.pressed, seen)
        sounds = [sound for deed in self._triggers.due(moment) for sound in self._do(deed, seen)]
        return self._orders(seen, tuple(sounds))

    def end_session(self, now_ns: int) -> None:
        """End the session before the task is done, with the row of an attempt under way."""
        self._on_event("session_end", {"t_ns": now_ns})
        self._attempts.end(ABORTED, SESSION_ENDED, self._adaptation.values, now_ns)
        self.state = TrialState.DONE

    def result(self) -> dict[str, Any]:
        """Totals under the keys of `mimics run --json`, see `Attempts.result`."""
        return self._attempts.result(self._last_ns)

    def _pauses(self, seen: Observation) -> bool:
        """Whether the task is halted in this frame; there is nothing to hold before the first one."""
        if self._seen is not None and self._pause.switched(seen, self.state):
            self._on_event("pause", {"t_ns": seen.now_ns, "on": self._pause.on})
            if self._pause.on:
                self._control.pause(seen.q)
            else:
                self._control.resume()
        return self._pause.on

    def _hold(self, now_ns: int) -> Observation:
        """Postpone all deadlines by the time since the last frame; return the observation of before the pause."""
        assert self._seen is not None and self._entered_ns is not None
        paused_ns = now_ns - self._last_ns
        self._last_ns = now_ns
        self._entered_ns += paused_ns
        self._goals.restart()
        self._approach.restart()
        self._announcement.postpone(paused_ns)
        if self._attempts.tally is not None:
            self._attempts.tally.pause(now_ns, paused_ns)
        for play in self._plays.values():
            play.pause(paused_ns)
        return structs.replace(self._seen, now_ns=now_ns, pressed=())

    def _advance(self, seen: Observation) -> tuple[TrialState | None, TrialState | None]:
        """Advance the adaptation and the state machine; return the states (left, entered) in this frame."""
        if self._entered_ns is None:
            self._last_ns = seen.now_ns
            self._enter(TrialState.APPROACH, seen)
            return None, TrialState.APPROACH
        seconds = max(0, seen.now_ns - self._last_ns) / 1e9
        self._adaptation.step(seconds)
        self._update_settings()
        if self.state is TrialState.TRAVEL:
            self._participation.see(seen, seconds)
        self._last_ns = seen.now_ns
        left, following = self.state, next_state(self.state, self._conditions(seen))
        if following is left:
            return None, None
        self._leave(left, following, seen)
        self._enter(following, seen)
        return left, following

    def _conditions(self, seen: Observation) -> Conditions:
        """Observe the robot in the present state and return the conditions of the next one."""
        elapsed, start = self._elapsed_s(seen.now_ns), self._spec.start
        goal = arrived = False
        if self.state is TrialState.TRAVEL and self._attempts.tally is not None:
            self._attempts.tally.add(seen)
            goal = self._goals.met(seen, elapsed) and self._participation.acted
        elif self.state in (TrialState.APPROACH, TrialState.READY):
            arrived = self._approach.arrived(seen)
        self._countdown.see(self.state, elapsed)
        if self.state is TrialState.APPROACH:
            self._approach.drive(seen, elapsed)
        return Conditions(
            elapsed_s=elapsed,
            latched=seen.latched,
            arrived=arrived,
            go=arrived and seen.quiet and elapsed >= max(start.ready_s, self._countdown.until_s),
            goal=goal,
            too_fast=goal and elapsed < self._least_s,
            start_limit_s=start.limit_s + self._approach.announced_s + self._countdown.until_s,
            time_limit_s=self._time_limit_s() if self._participation.acted else self._length_s(),
            result_s=self._spec.result_s,
            rest_s=self._rest_s(),
            trial_over=self._attempts.trial_over,
            attempts_left=self._attempts.attempts_left,
            trials_left=self._attempts.trials_left,
            given_up=bool(self._steering.gave_up),
            hurried=self._steering.hurried,
        )

    def _leave(self, state: TrialState, following: TrialState, seen: Observation) -> None:
        """Write the attempt's row if the next state ends it."""
        values = self._adaptation.values
        if following is TrialState.STOPPED:
            self._cause = seen.cause
            self._attempts.end(ABORTED, cause_words(seen.cause), values, seen.now_ns)
        elif following is TrialState.ABORTED:
            self._attempts.end(ABORTED, self._steering.gave_up or ABORTED_CAUSES[state], values, seen.now_ns)
        elif following in (TrialState.FINISHED, TrialState.TIMEOUT):
            outcome = FINISHED if following is TrialState.FINISHED else TIMEOUT
            self._attempts.end(outcome, "", values, seen.now_ns)
            self._result = self._attempts.trial_result(values, seen.now_ns)

    def _enter(self, state: TrialState, seen: Observation) -> None:
        announced = self.state is TrialState.REST  # that the robot will move, for some seconds
        self.state, self._entered_ns = state, seen.now_ns
        self._control.enter(state, seen.q)
        if state is TrialState.APPROACH:
            self._begin_attempt(seen.now_ns)
            self._approach.begin(announced=announced)
            self._approach.drive(seen, 0.0)
        elif state is TrialState.TRAVEL:
            self._goals.restart()
            self._attempts.start_attempt(seen)
            self._least_s = self._goals.way(seen) / self._fastest if self._fastest > 0.0 else 0.0
        trial = {"trial": self._attempts.number, "attempt": self._attempts.attempt}
        self._on_event("state", {"t_ns": seen.now_ns, "state": state.value, **trial})

    def _tell(self, row: Row) -> str:
        acted = self._participation.acted
        return what_happened(self._spec.goals, tuple(self._plays.values()), row, acted=acted, limb=self._limb)

    def _begin_attempt(self, now_ns: int) -> None:
        if self._attempts.trial_over:
            upcoming = settings_for(self._spec, self._adaptation.upcoming(self._attempts.number + 1))
            block = upcoming.task.get("block", 0)
            self._attempts.prefer(round(block) if isinstance(block, int | float) else 0)
        if self._attempts.begin(now_ns):
            self._adaptation.begin_trial(self._attempts.number, self._attempts.trial.values)
            self._report_clipped(now_ns)
            for play in self._plays.values():
                play.begin_trial(self._attempts.trial.label, self._attempts.number)
        self._update_settings()
        self._participation.restart()
        self._triggers.restart()
        for play in self._plays.values():
            play.begin_attempt()

    def _update_settings(self) -> None:
        """Set the settings to the present values, which are those of the last frame in most."""
        if self._settings_values != self._adaptation.values:
            self._settings_values = dict(self._adaptation.values)
            self._settings = settings_for(self._spec, self._settings_values, self._features)

    def _take(self, action: TaskAction, now_ns: int) -> None:
        """Carry out an action but for the parameters that a command has set in the same frame."""
        overruled = sorted(self._steering.overruled & action.values.keys())
        values = {name: value for name, value in action.values.items() if name not in overruled}
        self._adaptation.take(TaskAction(values, action.at_trial, action.propensity))
        lost = {"overruled": overruled} if overruled else {}
        self._on_event("action", {"t_ns": now_ns, "at_trial": action.at_trial, "values": dict(action.values), **lost})
        self._report_clipped(now_ns)

    def _report_clipped(self, now_ns: int) -> None:
        if self._adaptation.clipped:
            self._on_event("clipped", {"t_ns": now_ns, "names": list(self._adaptation.clipped)})

    def _do(self, deed: Deed, seen: Observation) -> list[SoundEvent]:
        """Carry out a trigger's action and return the sounds it starts."""
        if isinstance(deed, MessageDeed):
            self._announcement.show(deed.text, seen.now_ns + round(deed.seconds * 1e9))
        elif isinstance(deed, ActionDeed):
            self._take(TaskAction(deed.values), seen.now_ns)
        elif isinstance(deed, SoundDeed):
            place = seen.hip_world if deed.at_ball else None
            return [SoundEvent(deed.sound, seen.now_ns, place, deed.gain)]
        return []

    def _orders(self, seen: Observation, sounds: tuple[SoundEvent, ...]) -> TaskOrders:
        haptic = dict(self._settings.haptic)
        visual, taps, cues = dict(self._settings.visual), list[TactileEvent](), list[SoundTrigger]()
        obstacle = ""
        for play in self._plays.values():
            haptic |= play.orders
            visual |= shown(play.visual)
            taps += play.take_touches()
            cues += play.take_sounds()
            obstacle = play.take_obstacle() or obstacle
            for kind, data in play.take_events():
                self._on_event(kind, data)
        haptic = {**self._participation.allow(haptic), **self._control.wanted(), TRIAL: self._attempts.begun}
        gain = self._audio.since_last(self._settings.audio).get(GAIN.name)
        view = self._view(seen)
        return TaskOrders(
            haptic=HapticOrder(self._haptic.since_last(haptic), obstacle),
            visual=VisualOrder(self._visual.since_last(visual)),
            audio=AudioOrder(None if gain is None else GAIN.read(gain), sounds, tuple(cues)),
            tactile=TactileOrder(tuple(taps)),
            view=view,
            board=self._lay_out(seen, view),
            person_may_act=self.state is TrialState.TRAVEL and not self._pause.on,
            finished=self.done,
            result=self._result or self._step_result(seen.now_ns),
            demand=self._space.demand(self._adaptation.values),
            replies=self._steering.replies,
        )

    def _step_result(self, now_ns: int) -> TrialResult | None:
        """Return the result of a step inside the trial that ended in this frame, if the task's kind has steps."""
        if self.state is not TrialState.TRAVEL:
            return None
        for play in self._plays.values():
            step = play.step
            if step is not None:
                number, values, observed = self._attempts.number, self.values, dict(step.observed)
                return TrialResult(number, now_ns, "step", 0.0, step.reward, values=values, observed=observed)
        return None

    def _view(self, seen: Observation) -> TaskView:
        attempts, travels = self._attempts, self.state is TrialState.TRAVEL
        waits = self.state in (TrialState.APPROACH, TrialState.READY)
        elapsed = self._elapsed_s(seen.now_ns)
        done = seen.progress if self._plays else elapsed / self._length_s() if travels else 0.0
        progress = 0.0 if waits else min(max(done, 0.0), 1.0)
        which = attempts.number + 1, len(attempts.plan)
        return TaskView(self.state, progress, *which, elapsed, self._pause.on, self._countdown.reading)

    def _lay_out(self, seen: Observation, view: TaskView) -> Board:
        rest_s = max(0.0, self._rest_s() - view.elapsed_s)
        left_s = max(0.0, self._length_s() - view.elapsed_s) if self.state is TrialState.TRAVEL else None
        times = Times(view.elapsed_s, rest_s, left_s, self._length_s())
        board = self._layout.lay_out(seen, view, self._attempts, self._cause, times)
        line = PAUSED if self._pause.on else self._announcement.line(seen.now_ns, board.message)
        return structs.replace(board, message=line, count=self._countdown.count)

    def _elapsed_s(self, now_ns: int) -> float:
        return 0.0 if self._entered_ns is None else max(0, now_ns - self._entered_ns) / 1e9

    def _time_limit_s(self) -> float:
        return self._times.limit_s(self._attempts.trial, self._settings.task)

    def _length_s(self) -> float:
        return self._times.length_s(self._attempts.trial, self._settings.task)

    def _rest_s(self) -> float:
        return self._times.rest_s(self._attempts.trial, self._settings.task)
