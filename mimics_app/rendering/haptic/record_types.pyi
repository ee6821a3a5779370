"""Types of the records that compiled functions take, for type checkers: there is no module at run time.

One class for each numpy record dtype, with the Python type of each field; what a field is stands at the dtype. It is
written by `python -m tests.architecture.record_stub`, and a test holds it against the dtypes. Kernels import from here
under `TYPE_CHECKING` only: the cache of machine code, which is keyed by the sources a kernel reaches, does not look
at a stub, so no kernel is tied to every record.
"""

from collections.abc import Callable
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.loop.device_descriptor import Kin as Kin
from mimics_app.contracts.loop.object_rows import Rows as Rows
from mimics_app.rendering.haptic.channels import Channels as Channels
from mimics_app.rendering.haptic.channels import Work as Work
from mimics_app.rendering.haptic.mesh_table import MeshTable as MeshTable
from mimics_app.rendering.haptic.objects import ObjectWork as ObjectWork
from mimics_app.rendering.haptic.ridge_table import RidgeTable as RidgeTable

Floats = NDArray[np.float64]
Floats32 = NDArray[np.float32]
Ints = NDArray[np.int64]
Ints32 = NDArray[np.int32]
Ints16 = NDArray[np.int16]
Ints8 = NDArray[np.int8]
Bytes = NDArray[np.uint8]

R = TypeVar("R")

class Table(Protocol[R]):
    """An array of records."""

    @property
    def shape(self) -> tuple[int, ...]: ...
    @property
    def size(self) -> int: ...
    def __len__(self) -> int: ...
    def __getitem__(self, index: int, /) -> R: ...
    def __setitem__(self, index: int, value: R, /) -> None: ...

class Description(Protocol):
    """A record that describes a device for its kinematics."""

    joints: int
    contacts: int
    geometry: Floats

Read = Callable[[Floats, Floats, Floats, int], int]
Write = Callable[[Floats, Floats, int], int]
Field = Callable[[Floats, Floats, Floats, float, Floats], None]
Fields = tuple[Field, ...]
Controller = Callable[[Kin, ControlInputRecord, Floats, Floats, ControlWorkRecord, ControlOutputRecord], None]
Controllers = tuple[Controller, ...]
Simulate = Callable[[Rows, ObjectWork, ObjectCountsRecord, Floats, Fields, float, Floats], None]
Tick = Callable[
    [
        SceneRecord,
        Rows,
        ObjectWork,
        Simulate,
        Fields,
        Kin,
        Table[StateRecord],
        Floats,
        int,
        int,
        int,
        float,
        float,
        Floats,
        SampleRecord,
    ],
    None,
]
LoopTick = Callable[
    [Channels, Work, Tick, Read, Write, Floats, Simulate, Fields, Kin, int, int, float, int, float], int
]

class ObjectCountsRecord:
    """`mimics_app.contracts.loop.haptic_objects.OBJECT_COUNTS`."""

    shapes: int
    bodies: int
    effects: int
    points: int
    wires: int
    revision: int
    tunnels: int
    curves: int

class ShapeRecord:
    """`mimics_app.contracts.loop.haptic_objects.SHAPE`."""

    kind: int
    body: int
    enabled: int
    material: int
    mesh: int
    law: int
    position: Floats
    orientation: Floats
    size: Floats
    rounding: float
    stiffness: float
    damping: float
    exponent: float
    friction_static: float
    friction_dynamic: float
    friction_stiffness: float
    texture_height: float
    texture_length: float

class BodyRecord:
    """`mimics_app.contracts.loop.haptic_objects.BODY`."""

    flags: int
    integrator: int
    spawn: int
    mass: float
    inertia: Floats
    centre: Floats
    position: Floats
    orientation: Floats
    velocity: Floats
    omega: Floats
    gravity: Floats
    damping_translation: float
    damping_rotation: float
    force_aux: Floats
    torque_aux: Floats
    grip: int
    crush_force: float

class MotionRecord:
    """`mimics_app.contracts.loop.haptic_objects.MOTION`."""

    position: Floats
    orientation: Floats
    rotation: Floats
    centre: Floats
    velocity: Floats
    omega: Floats
    momentum: Floats
    force: Floats
    torque: Floats
    force_user: Floats
    spawn: int
    touched: int
    collided: int
    asleep: int
    quiet_ticks: int

class EffectRecord:
    """`mimics_app.contracts.loop.haptic_objects.EFFECT`."""

    kind: int
    enabled: int
    body: int
    on_body: int
    field: int
    path: int
    position: Floats
    direction: Floats
    stiffness: float
    damping: float
    radius: float
    force: float
    frequency: float
    slip: float
    parameters: Floats
    contact: int

class PointRecord:
    """`mimics_app.contracts.loop.haptic_objects.POINT`."""

    offset: Floats
    radius: float
    enabled: int
    contact: int

class WireRecord:
    """`mimics_app.contracts.loop.haptic_objects.WIRE`."""

    source: int
    source_row: int
    target: int
    target_row: int
    gain: Floats
    offset: Floats

class TunnelRecord:
    """`mimics_app.contracts.loop.haptic_objects.TUNNEL`."""

    pieces: int
    projection: int
    frenet: int
    centre: Floats
    radius: Floats
    arc_length: Floats
    normal: Floats
    radius_scale: float
    stiffness: float
    damping: float
    drag: float
    drag_growth: float
    centring: float
    advance: float
    contact: int

class SceneRecord:
    """`mimics_app.contracts.loop.haptic.SCENE`."""

    sequence: int
    resets: int
    trial: int
    controller: int
    controller_names: Bytes
    leads: Ints8
    commands: Ints8
    targets: Ints8
    each_joint: Ints8
    controller_parameters: Floats
    target: Floats
    obstacle_calls: int
    obstacle: int
    drive_rate: float
    force_driven: int
    drive_stiffness: float
    drive_damping: float
    joints: int
    contacts: int
    torques: int
    polar: int
    geometry: Floats
    joint_inertia: Floats32
    R_world_from_robot: Floats
    origin_world: Floats
    virtual_mass: float
    virtual_damping: float
    ball_radius_min: float
    ball_radius_max: float
    grasp_force_full: float
    reference_cadence: float
    reference_speed: float
    reference_amplitude: float
    guidance: float
    cadence_rate: float
    speed_rate: float
    amplitude_rate: float
    guidance_rate: float
    natural_step: float
    longest_step: float
    force_limit: float
    force_rate_limit: float
    power_limit: float
    energy_limit: float
    velocity_limit: float
    measured_force_limit: float
    position_jump: float
    max_acceleration: float
    max_velocity: float
    drive_speed: float
    drive_force: float
    joint_min: Floats
    joint_max: Floats
    joint_velocity: Floats32
    joint_acceleration: Floats32
    workspace_margin: float
    ramp_time: float
    ramp_force: float
    cap: int
    cap_margin: float
    device_delay: float
    device_damping: float
    device_mass: float
    device_lag: float
    device_filter: float
    device_quantum: float
    arm_damping: float
    passivity: int
    passivity_damping: float
    tank_size: float
    tank_refill: float
    tank_return: float
    late_hold_ns: int
    late_damp_ns: int
    late_stop_ns: int
    missed_stop: int
    late_latches: int
    stale_warn_ns: int
    stale_stop_ns: int
    own_tunnel: int
    objects: ObjectCountsRecord

class InboxRecord:
    """`mimics_app.contracts.loop.haptic.INBOX`."""

    target_world: Floats
    grasp: Floats
    buttons: int
    active: int
    trial: int

class SampleRecord:
    """`mimics_app.contracts.loop.haptic.SAMPLE`."""

    t: float
    tick: float
    q: Floats
    dq: Floats
    f_meas: Floats
    grasp: float
    buttons: float
    age: float
    delay: float
    status: float
    sequence: float
    stop_word: float
    held: float
    period_s: float
    hip_world: Floats
    v_world: Floats
    f_virt_world: Floats
    f_user_world: Floats
    f_shapes: Floats
    f_effects: Floats
    f_grip: Floats
    touching: float
    depth: float
    touched_shape: float
    held_body: float
    bodies: float
    f_tunnel: Floats
    s: float
    progress: float
    distance: float
    offset_n: float
    offset_b: float
    penetration: float
    ball_radius: float
    tunnel_radius: float
    v_virtual: Floats
    command: Floats
    f_command: Floats
    ramp: float
    state: float
    cause: float
    stiffness_limit: float
    margin: float
    energy: float
    stiffness_share: float
    credit: float
    passivity: float
    tank: float
    tank_share: float
    lateness_ns: float
    duration_ns: float
    torque_meas: Floats
    torque_command: Floats
    calm: float
    f_ordered: Floats
    phase: float
    amplitude: float
    q_reference: Floats
    dq_reference: Floats
    ddq_reference: Floats
    guidance: Floats
    gait_state: float
    numbers: Floats
    free_leg: float
    belt_travel: float
    left_strikes: float
    right_strikes: float
    further: Table[PointSampleRecord]

class SnapshotRecord:
    """`mimics_app.contracts.loop.haptic.SNAPSHOT`."""

    tick: int
    t_ns: int
    q: Floats
    grasp: float
    hip_world: Floats
    v_world: Floats
    f_meas_world: Floats
    f_user_world: Floats
    f_grip: Floats
    partners: int
    held_body: int
    crushed_body: int
    progress: float
    distance: float
    penetration: float
    ball_radius: float
    ramp: float
    state: int
    cause: int
    margin: float
    energy: float
    stiffness_share: float
    torque_meas: Floats
    calm: float
    phase: float
    gait_state: int
    free_leg: int
    belt_travel: float
    left_strikes: int
    right_strikes: int
    wall_force: float
    wall_normal: Floats
    force_peak: float
    distance_peak: float
    progress_peak: float
    own_work: float
    quiet_ticks: int
    further: Table[PointSnapshotRecord]

class PointSampleRecord:
    """`mimics_app.contracts.loop.haptic.POINT_SAMPLE`."""

    f_meas: Floats
    grasp: float
    hip_world: Floats
    v_world: Floats
    f_virt_world: Floats
    f_user_world: Floats
    f_shapes: Floats
    f_effects: Floats
    f_grip: Floats
    touching: float
    depth: float
    touched_shape: float
    held_body: float
    f_tunnel: Floats
    s: float
    progress: float
    distance: float
    offset_n: float
    offset_b: float
    penetration: float
    ball_radius: float
    tunnel_radius: float
    f_command: Floats
    stiffness_limit: float
    margin: float
    energy: float
    stiffness_share: float
    credit: float
    passivity: float
    tank: float
    tank_share: float
    calm: float
    f_ordered: Floats

class PointSnapshotRecord:
    """`mimics_app.contracts.loop.haptic.POINT_SNAPSHOT`."""

    grasp: float
    hip_world: Floats
    v_world: Floats
    f_meas_world: Floats
    f_user_world: Floats
    f_grip: Floats
    partners: int
    held_body: int
    crushed_body: int
    progress: float
    distance: float
    penetration: float
    ball_radius: float
    margin: float
    energy: float
    stiffness_share: float
    calm: float
    wall_force: float
    wall_normal: Floats
    force_peak: float
    distance_peak: float
    progress_peak: float
    own_work: float

class EventRecord:
    """`mimics_app.contracts.loop.haptic.EVENT`."""

    t_ns: int
    tick: int
    kind: int
    body_a: int
    body_b: int
    material_a: int
    material_b: int
    position_world: Floats32
    normal_world: Floats32
    speed: float
    force: float
    value: float

class ContactForceRecord:
    """`mimics_app.contracts.loop.contact_force.CONTACT_FORCE`."""

    t_ns: int
    body_a: int
    body_b: int
    force: float

class StruckRecord:
    """`mimics_app.contracts.loop.contact_force.STRUCK`."""

    body_a: int
    body_b: int
    left: int

class CurveRecord:
    """`mimics_app.contracts.loop.reference_rows.CURVE`."""

    kind: int
    grows_with: int
    used: int
    shift: float
    rest: float
    least: float
    guidance: float
    values: Floats

class SlopesRecord:
    """`mimics_app.rendering.haptic.reference.generator.SLOPES`."""

    value: float
    by_phase: float
    by_phase_twice: float
    by_u: float
    by_u_twice: float
    by_both: float

class RampRecord:
    """`mimics_app.rendering.haptic.reference.generator.RAMP`."""

    led: float
    half: float
    value: float
    rate: float
    acceleration: float

class ReferenceRecord:
    """`mimics_app.rendering.haptic.reference.generator.REFERENCE`."""

    begun: int
    cadence: RampRecord
    speed: RampRecord
    step: RampRecord
    amplitude: RampRecord
    led: Floats
    half: Floats
    share: RampRecord
    slopes: SlopesRecord

class ControlInputRecord:
    """`mimics_app.contracts.loop.controller_port.CONTROL_INPUT`."""

    joints: int
    contacts: int
    geometry: Floats
    joint_inertia: Floats
    joint_min: Floats
    joint_max: Floats
    virtual_mass: float
    max_acceleration: float
    max_velocity: float
    target: Floats
    dt: float
    tick: int
    safety: int
    ramp: float
    started: int
    obstacle: int
    virtual_damping: float
    q: Floats
    dq: Floats
    torque_meas: Floats
    x: Floats
    v: Floats
    f_meas: Floats
    f_user: Floats
    phase: float
    q_reference: Floats
    dq_reference: Floats
    ddq_reference: Floats
    guidance: Floats

class ControlOutputRecord:
    """`mimics_app.contracts.loop.controller_port.CONTROL_OUTPUT`."""

    dq: Floats
    v: Floats
    points_given: int
    force: Floats
    torque: Floats
    braked: int
    stop: int
    belt: float
    gait: int
    free_leg: int
    strikes: Ints
    numbers: Floats

class ControlWorkRecord:
    """`mimics_app.contracts.loop.controller_port.CONTROL_WORK`."""

    points: Floats
    velocities: Floats
    jacobian: Floats
    matrix: Floats
    side: Floats
    place: Floats
    step: Floats
    wish: Floats
    reached: Floats
    forces: Floats

class ContactRecord:
    """`mimics_app.rendering.haptic.kernels.contact_records.CONTACT`."""

    depth: float
    normal: Floats
    previous: Floats
    feature: int
    inside: int
    known: int

class FrictionRecord:
    """`mimics_app.rendering.haptic.kernels.contact_records.FRICTION`."""

    anchor: Floats
    bristle: Floats
    touching: int
    sticking: int

class TunnelStateRecord:
    """`mimics_app.rendering.haptic.kernels.objects.records.TUNNEL_STATE`."""

    ball_radius_rate: float
    tracking: int
    s: float
    distance: float
    tracked: Floats
    ticks: int
    restarts: int
    status: int
    progress: float
    offset_n: float
    offset_b: float
    radius: float
    penetration: float
    approach_speed: float
    force_world: Floats
    assist_world: Floats
    softening: float
    damping_softening: float
    most_drag: float
    most_centring: float
    share: float
    force_tnb: Floats
    wall_force: float
    normal_world: Floats
    tangent: Floats
    normal_n: Floats
    binormal: Floats

class DynamicsRecord:
    """`mimics_app.rendering.haptic.kernels.objects.records.DYNAMICS`."""

    inertia: Floats
    axes: Floats
    inverse: Floats
    tensor: Floats
    vectors: Floats
    rest_force: Floats
    rest_torque: Floats
    placed: int
    stirred: int

class GripRecord:
    """`mimics_app.rendering.haptic.kernels.objects.records.GRIP`."""

    body: int
    spawn: int
    crushed: int
    half_width: float
    offset: float
    twist: float
    contact_a: Floats
    contact_b: Floats
    friction_a: FrictionRecord
    friction_b: FrictionRecord
    axis: Floats
    across: Floats
    centre: Floats
    velocity: Floats
    low: float
    high: float
    place: Floats
    moving: Floats
    force: Floats
    shift: Floats
    hold: Floats

class TrackingRecord:
    """`mimics_app.rendering.haptic.kernels.objects.records.TRACKING`."""

    placed_revision: int
    posed_revision: int
    paired_revision: int
    moving: int
    turn: Floats

class MemoryRecord:
    """`mimics_app.rendering.haptic.kernels.objects.records.MEMORY`."""

    contact: ContactRecord
    anchor: Floats
    touching: int
    sticking: int
    tick: int

class WallTouchRecord:
    """`mimics_app.rendering.haptic.kernels.objects.records.WALL_TOUCH`."""

    row: int
    depth: float
    lowered: float
    rate: float
    normal: Floats
    direction: Floats
    slope: Floats

class SolidRecord:
    """`mimics_app.rendering.haptic.kernels.objects.records.SOLID`."""

    kind: int
    body: int
    enabled: int
    mesh: int
    size: Floats
    rounding: float
    radius: float
    local: Floats
    rotation: Floats
    position: Floats
    low: Floats
    high: Floats
    fat_low: Floats
    fat_high: Floats

class PairRecord:
    """`mimics_app.rendering.haptic.kernels.objects.records.PAIR`."""

    a: int
    b: int
    body_a: int
    body_b: int
    kept: int
    law: int
    slot: int
    stiffness: float
    damping: float
    exponent: float
    friction_static: float
    friction_dynamic: float
    friction_stiffness: float
    friction_damping: float
    normal: Floats
    stretch: Floats
    twist: float
    share: float
    force: float
    rest_force: float
    feature: int
    touching: int
    sticking: int
    ticks_apart: int

class ScratchRecord:
    """`mimics_app.rendering.haptic.kernels.objects.records.SCRATCH`."""

    feature_a: Floats
    feature_b: Floats
    polygon: Floats
    points: Floats
    simplex: Floats
    cosines: Floats
    normals: Floats
    mesh_point: Floats
    mesh_closest: Floats
    mesh_normal: Floats

class SweepRecord:
    """`mimics_app.rendering.haptic.kernels.objects.records.SWEEP`."""

    pairs: int
    sorted: int
    walls: int
    axis: int
    left_out: int
    most_left_out: int
    remade: int

class MeshRecord:
    """`mimics_app.rendering.haptic.kernels.objects.records.MESH`."""

    first_triangle: int
    triangles: int
    first_node: int
    leaves: int
    closed: int
    first_hull: int
    hull_corners: int
    first_edge: int
    edges: int

class RidgesRecord:
    """`mimics_app.rendering.haptic.kernels.objects.records.RIDGES`."""

    first_ridge: int
    ridges: int
    first_node: int
    leaves: int

class EffectMemoryRecord:
    """`mimics_app.rendering.haptic.kernels.objects.records.EFFECT_MEMORY`."""

    position: Floats
    size: float
    stiffness: float
    quarantined: int
    sticking: int
    anchor: Floats
    path: TunnelStateRecord
    p: Floats
    v: Floats
    arm: Floats
    force: Floats
    damper: Floats
    held: int

class ContactScratchRecord:
    """`mimics_app.rendering.haptic.kernels.objects.contact_scratch.CONTACT_SCRATCH`."""

    tick: int
    revision: int
    known: Ints
    last_points: Floats
    last: Floats
    point: Floats
    point_velocity: Floats
    on_point: Floats
    radius: float
    contact: int
    rotation: Floats
    position: Floats
    drift: Floats
    spin: Floats
    p: Floats
    v: Floats
    slope: Floats
    lowered: float
    rate: float
    ripple: Floats
    force: Floats
    normal: Floats
    stiffness: float
    damping: float
    hold: float
    a: Floats
    b: Floats
    c: Floats

class BirthRecord:
    """`mimics_app.rendering.haptic.kernels.objects.contact_scratch.BIRTH`."""

    tick: int
    form: ShapeRecord

class BeforeRecord:
    """`mimics_app.rendering.haptic.kernels.objects.contact_scratch.BEFORE`."""

    position: Floats
    rotation: Floats
    spawn: int

class TotalsRecord:
    """`mimics_app.rendering.haptic.kernels.objects.totals.TOTALS`."""

    shape_force: Floats
    effect_force: Floats
    ordered_force: Floats
    grip_force: Floats
    stiffness: float
    even_stiffness: float
    even_damping: float
    listed: int
    touching: int
    static_touching: int
    depth: float
    shape: int
    normal: Floats
    approach_speed: float
    held: int
    crushed: int
    impact: float
    impact_force: float
    impact_a: int
    impact_b: int
    impact_position: Floats
    impact_normal: Floats
    status: int
    left_out: int
    quarantined: int

class TouchRecord:
    """`mimics_app.rendering.haptic.kernels.objects.touches.TOUCH`."""

    in_contact: int
    clear_ticks: int
    change: int

class RegionRecord:
    """`mimics_app.rendering.haptic.kernels.closed_region.REGION`."""

    known: int
    period: float
    delay: float
    mass: float
    damping: float
    quantum: float
    driven: int
    most_damping: float
    best_damping: float
    viscosity: float
    stiffness_factor: Floats
    damping_factor: Floats
    bound: Floats
    edge: Floats

class TouchedRecord:
    """`mimics_app.rendering.haptic.kernels.directions.TOUCHED`."""

    shape: int
    normal: Floats
    stiffness: float
    damping: float
    hold_stiffness: float
    hold_damping: float
    margin: float

class SpanRecord:
    """`mimics_app.rendering.haptic.kernels.directions.SPAN`."""

    stiffness: Floats
    damping: Floats
    tensor: Floats
    scaled: Floats
    vectors: Floats
    direction: Floats
    limit: float
    margin: float

class SwingRecord:
    """`mimics_app.rendering.haptic.kernels.oscillation.SWING`."""

    line: Floats
    stages: Floats
    moved: Floats
    power: float
    force: float
    lately: float
    speed: float
    ordered: float
    time: float
    free: float
    settling: float
    begun: int
    reported: int
    lost: int
    calm: float
    least_calm: float
    count: int
    worst: float

class ObserverRecord:
    """`mimics_app.rendering.haptic.kernels.passivity.OBSERVER`."""

    energy: float
    lowest: float
    position: Floats
    force: Floats
    known: int

class ActingRecord:
    """`mimics_app.rendering.haptic.kernels.acting.ACTING`."""

    known: int
    position: Floats
    v: Floats
    displacement: Floats
    contact: Floats
    active: Floats
    rest: Floats
    limited: Floats
    contacts: Floats
    actives: Floats
    rests: Floats
    credit: float
    ramp: float
    free_ticks: int
    tank: float
    filled: int
    inflow: float
    wall_share: float
    shape_share: float
    effect_share: float
    both_share: float
    touching: int
    tank_share: float
    rendered_share: float
    at_limit: int
    passivity: float
    least_share: float
    least_tank: float
    passivity_ticks: int

class ControlRecord:
    """`mimics_app.rendering.haptic.kernels.controller_slot.CONTROL`."""

    functions: Ints
    slot: int
    now: ControlInputRecord
    out: ControlOutputRecord
    memory: Floats
    added_force: Floats
    added_torque: Floats

class HoldingRecord:
    """`mimics_app.rendering.haptic.kernels.state.HOLDING`."""

    there: int
    row: int
    chosen: int
    status: int
    s: float
    penetration: float
    approach_speed: float
    wall_force: float
    force_world: Floats
    assist_world: Floats
    normal_world: Floats
    stiffness: float
    damping: float
    centring: float

class OwnTunnelRecord:
    """`mimics_app.rendering.haptic.kernels.state.OWN_TUNNEL`."""

    force_tnb: Floats
    s: float
    progress: float
    distance: float
    offset_n: float
    offset_b: float
    penetration: float
    radius: float

class StateRecord:
    """`mimics_app.rendering.haptic.kernels.state.STATE`."""

    q: Floats
    grasp: float
    hip_world: Floats
    v_world: Floats
    f_meas_world: Floats
    f_virt_world: Floats
    f_user_world: Floats
    partners: int
    bodies: float
    ball_radius: float
    v_virtual: Floats
    command: Floats
    f_command: Floats
    ramp: float
    cause: int
    stiffness_limit: float
    margin: float
    stiffness_share: float
    torque_meas: Floats
    torque_command: Floats
    calm: float
    phase: float
    amplitude: float
    q_reference: Floats
    dq_reference: Floats
    ddq_reference: Floats
    guidance: Floats
    gait_state: int
    free_leg: int
    belt_travel: float
    left_strikes: int
    right_strikes: int
    force_peak: float
    distance_peak: float
    progress_peak: float
    own_work: float
    tick: int
    contacts: int
    safety: int
    resets: int
    sequence: int
    trial: int
    obstacle_calls: int
    strained_ticks: int
    lag: Floats
    refused_ticks: int
    quiet_ticks: int
    answered: int
    readable: int
    objects_failed: int
    stale: int
    age: float
    delay: float
    state_changed: int
    tripped: int
    jumped: int
    cap_began: int
    limit_began: int
    stale_began: int
    parameters_taken: int
    gait_changed: int
    contact_change: int
    margin_lost: int
    reported_margin: float
    reported_share: float
    reported_force: float
    dq: Floats
    f_meas: Floats
    buttons: int
    hip: Floats
    v: Floats
    placed: int
    last_hip: Floats
    f_contact: Floats
    f_active: Floats
    f_rest: Floats
    f_wanted: Floats
    f_user: Floats
    in_contact: int
    clear_ticks: int
    period: float
    in_touch: int
    capped: int
    observer: ObserverRecord
    warned: int
    touched: int
    least_margin: float
    least_limit: float
    wall_margin: float
    wall_touched: int
    least_wall_margin: float
    swing: SwingRecord
    swing_reported: int
    reported_swing: float
    region: RegionRecord
    span: SpanRecord
    least_energy: float
    dq_virtual: Floats
    reference: Floats
    joint_reference: Floats
    reference_state: ReferenceRecord
    arrived: int
    acting: ActingRecord
    joint_work: ControlWorkRecord
    control: ControlRecord
    work_a: Floats
    work_b: Floats
    ball_radius_rate: float
    tunnel: HoldingRecord
    own_tunnel: OwnTunnelRecord

class SequenceRecord:
    """`mimics_app.rendering.haptic.control.lokomat.obstacle_sequence.SEQUENCE`."""

    state: int
    cause: int
    free_leg: int
    ticks: int
    hard: int
    braked: int
    held: Ints
    guidance: Floats
    belt: float

class SequenceSettingsRecord:
    """`mimics_app.rendering.haptic.control.lokomat.obstacle_sequence.SEQUENCE_SETTINGS`."""

    guidance: Floats
    guidance_step: float
    belt_step: float
    longest: Ints
    shown: int

class SequenceFactsRecord:
    """`mimics_app.rendering.haptic.control.lokomat.obstacle_sequence.SEQUENCE_FACTS`."""

    command: int
    leg: int
    fault: int
    standing: int
    extended: Ints
    at_obstacle: int
    clear: int
    overstepped: int
    at_start: int

class OutlineEdgeRecord:
    """`mimics_app.rendering.haptic.control.lokomat.sagittal_outline.OUTLINE_EDGE`."""

    start: Floats
    end: Floats
    normal: Floats

class OutlineRecord:
    """`mimics_app.rendering.haptic.control.lokomat.sagittal_outline.OUTLINE`."""

    edges: Table[OutlineEdgeRecord]
    count: int
    radius: float

class LegFrameRecord:
    """`mimics_app.rendering.haptic.control.lokomat.foot_constraint.LEG_FRAME`."""

    geometry: Floats
    links: Floats
    place: Floats

class FootSurfaceRecord:
    """`mimics_app.rendering.haptic.control.lokomat.foot_constraint.FOOT_SURFACE`."""

    distance: float
    normal: Floats
    slope: Floats
    path: Floats
    bend: Floats
    lever: Floats

class ImpulseRecord:
    """`mimics_app.rendering.haptic.control.lokomat.contact_impulse.IMPULSE`."""

    touching: int
    left: int
    force: float
    offset: float

class ImpulseSettingsRecord:
    """`mimics_app.rendering.haptic.control.lokomat.contact_impulse.IMPULSE_SETTINGS`."""

    ticks: int
    restitution: float
    force_limit: float
    fading: float

class FootSettingsRecord:
    """`mimics_app.rendering.haptic.control.lokomat.foot_contact.FOOT_SETTINGS`."""

    stiffness: float
    damping: float
    friction: float
    anchor: float
    threshold: float
    as_printed: int
    impulse: ImpulseSettingsRecord

class FootContactRecord:
    """`mimics_app.rendering.haptic.control.lokomat.foot_contact.FOOT_CONTACT`."""

    impulse: ImpulseRecord
    friction: FrictionRecord
    way: Floats
    drag: Floats
    normal_force: float

class ShaftSettingsRecord:
    """`mimics_app.rendering.haptic.control.lokomat.shaft_admittance.SHAFT_SETTINGS`."""

    mass: Floats
    damping: Floats
    friction: Floats
    sensor_sign: float
    speed_limit: Floats
    force_limit: Floats
    as_printed: int

class SurfaceSettingsRecord:
    """`mimics_app.rendering.haptic.control.lokomat.constrained_shafts.SURFACE_SETTINGS`."""

    friction: int
    mu: float
    anchor: float
    hold: float

class ShaftsRecord:
    """`mimics_app.rendering.haptic.control.lokomat.constrained_shafts.SHAFTS`."""

    eta: Floats
    rate: Floats
    theta: Floats
    touching: int
    leader: int
    normal_force: float
    drag: Floats
    way: Floats
    anchor: FrictionRecord
    surface: FootSurfaceRecord
    work_eta: Floats
    work_theta: Floats

class PositionSettingsRecord:
    """`mimics_app.rendering.haptic.control.lokomat.position_control.POSITION_SETTINGS`."""

    links: Floats
    carried: Floats
    motor: Floats
    bandwidth: float
    ratio: float
    stiffness: Floats
    computed: int

class GuidanceSettingsRecord:
    """`mimics_app.rendering.haptic.control.lokomat.guidance_force.GUIDANCE_SETTINGS`."""

    stiffness: Floats
    damping: Floats
    window: float
    width: float

class EncoderSpeedRecord:
    """`mimics_app.rendering.haptic.control.lokomat.encoder_speed.ENCODER_SPEED`."""

    count: int
    past: Floats

class LoadSettingsRecord:
    """`mimics_app.rendering.haptic.control.lokomat.leg_control.LOAD_SETTINGS`."""

    links: Floats
    weight: float
    friction: float
    coulomb: Floats
    viscous: Floats
    slow: float

class LegSettingsRecord:
    """`mimics_app.rendering.haptic.control.lokomat.leg_control.LEG_SETTINGS`."""

    frame: LegFrameRecord
    outline: OutlineRecord
    foot: FootSettingsRecord
    shafts: ShaftSettingsRecord
    surface: SurfaceSettingsRecord
    play: Floats
    encoder: float
    position: PositionSettingsRecord
    load: LoadSettingsRecord
    guidance: GuidanceSettingsRecord
    wall_force: float

class LegInputRecord:
    """`mimics_app.rendering.haptic.control.lokomat.leg_control.LEG_INPUT`."""

    q: Floats
    dq: Floats
    torque: Floats
    q_ref: Floats
    dq_ref: Floats
    ddq_ref: Floats
    guidance: Floats
    force: Floats
    hard: int
    dt: float

class LegStateRecord:
    """`mimics_app.rendering.haptic.control.lokomat.leg_control.LEG_STATE`."""

    started: int
    shafts: ShaftsRecord
    encoders: Table[EncoderSpeedRecord]
    contact: FootContactRecord
    surface: FootSurfaceRecord
    motor: Floats
    tau: Floats
    x_real: Floats
    x_des: Floats
    f_x: Floats
    guided: Floats
    speed: Floats
    force: Floats
    more: Floats
    wish_rate: Floats
    rate: Floats
    place: Floats

class LegLimitsRecord:
    """`mimics_app.rendering.haptic.control.lokomat.gait_limits.LEG_LIMITS`."""

    force: float
    rise: float
    power: float
    stiffness: float

class HeelStrikeRecord:
    """`mimics_app.rendering.haptic.control.lokomat.heel_strike.HEEL_STRIKE`."""

    count: int
    swings: int
    begun: int
    x: float
    v: float
    a: float

class EncoderWatchRecord:
    """`mimics_app.rendering.haptic.control.lokomat.encoder_watch.ENCODER_WATCH`."""

    begun: int
    q: Floats
    least: Floats
    most: Floats
    waited: Floats

class SensorWatchRecord:
    """`mimics_app.rendering.haptic.control.lokomat.sensor_watch.SENSOR_WATCH`."""

    torque: Floats
    force: Floats
    repeated: Floats

class WalkRecord:
    """`mimics_app.rendering.haptic.controllers.orthosis_walk.WALK`."""

    sequence: SequenceRecord
    settings: SequenceSettingsRecord
    facts: SequenceFactsRecord
    limits: LegLimitsRecord
    walked: float
    x: Floats
    distance: Floats
    away: Floats
    jacobian: Floats
    last: Floats
    called: int
