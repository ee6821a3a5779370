"""Component types of the robot, the person on it, and the tunnel (D2.1 4.2). SI units, angles radians.

Frames: `world` is the scene's, `robot` the HapticMaster's WCS (x radial, y lateral, z up).
Defaults of `Safety` also hold in a scene without that component; the report states the values in force.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta

from mimics_app.world.components.bounds import (
    Acceleration,
    ContactName,
    Damping,
    Factor,
    Force,
    Frequency,
    Mass,
    Point,
    PositiveForce,
    Seconds,
    Share,
    Speed,
    Stiffness,
)
from mimics_app.world.components.curves import Curve
from mimics_app.world.components.registry import Component, component

__all__ = [
    "Admittance",
    "Ball",
    "Controller",
    "Impedance",
    "JointPd",
    "NextMark",
    "Patient",
    "Robot",
    "RobotToWorld",
    "Safety",
    "Tunnel",
    "WorldPd",
]

Arm = Annotated[float, Meta(gt=0, le=10)]
Reach = Annotated[float, Meta(ge=0, le=10)]
"""Length within the reach of a robot beside a person [m], that may be 0."""
_Ranges = tuple[Arm, Arm, Arm, Arm, Arm, Arm]
_Opening = Annotated[float, Meta(ge=0.05, le=60)]
_Letter = Annotated[float, Meta(gt=0, le=720)]
_Level = Annotated[float, Meta(ge=-120, le=0)]
_Joint = Annotated[float, Meta(ge=-100, le=100)]
Joints = Annotated[tuple[_Joint, ...], Meta(min_length=1, max_length=8)]
_MovingMass = Annotated[float, Meta(ge=0, le=1e3)]
Masses = tuple[_MovingMass, _MovingMass, _MovingMass]
_JointRate = Annotated[float, Meta(gt=0, le=1e5)]
Rates = Annotated[tuple[_JointRate, ...], Meta(min_length=1, max_length=8)]
_Gain = Annotated[float, Meta(ge=0, le=1e4)]
Gains = Annotated[tuple[_Gain, ...], Meta(min_length=1, max_length=8)]
_Parameter = Annotated[float, Meta(ge=-1e9, le=1e9)]
_Parameters = Annotated[tuple[_Parameter, ...], Meta(min_length=1, max_length=64)]
_Cosine = Annotated[float, Meta(ge=-2, le=2)]
Row = tuple[_Cosine, _Cosine, _Cosine]
TunnelRadius = Annotated[float, Meta(ge=0, le=10)]
Radii = Annotated[tuple[TunnelRadius, ...], Meta(max_length=1000)]
Visits = Annotated[tuple[str, ...], Meta(max_length=1000)]


@component("tunnel", limit=100)
class Tunnel(Curve, frozen=True):
    """The tunnel of D2.1 4.2.10: a B-spline bisector, a radius along it, and the forces of its wall."""

    radius: Annotated[
        TunnelRadius | Radii, Meta(description="Radius [m]; or several, evenly spaced from start to end")
    ] = 0.04
    frame: Annotated[
        Literal["rotation_minimising", "frenet"],
        Meta(description="Direction of n: rotation-minimising transport, or to the centre of curvature (Frenet)"),
    ] = "rotation_minimising"
    contact: Annotated[
        ContactName | None, Meta(description="Point of contact of the device that it holds; absent: its first")
    ] = None
    radius_scale: Annotated[Factor, Meta(description="Factor on `radius`; 0 keeps the ball on the bisector")] = 1.0
    stiffness: Annotated[Stiffness, Meta(description="Stiffness of the wall [N/m]")] = 1500.0
    damping: Annotated[Damping, Meta(description="Damping of the wall along its normal [N s/m]")] = 10.0
    drag: Annotated[Damping, Meta(description="Damping along the tunnel [N s/m]")] = 2.0
    drag_growth: Annotated[
        Factor, Meta(description="Growth of drag per metre that the ball exceeds the tunnel [N s/m per m]")
    ] = 2000.0
    centring: Annotated[Stiffness, Meta(description="Assistance towards the bisector [N/m]")] = 0.0
    advance: Annotated[Force, Meta(description="Assistance along the tunnel towards its end [N]")] = 0.0


class RobotToWorld(Component, frozen=True):
    """Pose of the robot's WCS in the world."""

    rotation: Annotated[tuple[Row, Row, Row], Meta(description="R_world_from_robot, rows; a rotation")] = (
        (0.0, 1.0, 0.0),
        (0.0, 0.0, 1.0),
        (1.0, 0.0, 0.0),
    )
    translation: Annotated[Point, Meta(description="WCS origin in the world [m]")] = (0.0, 0.0, 0.0)


ButtonCommand = Literal["", "stop", "reset", "start_trial", "pause", "resume", "skip", "repeat", "end"]
"""What a device's button may command."""


@component("robot", limit=100, once=True)
class Robot(Component, frozen=True):
    """The robot or its simulator. Workspace figures are the HapticMaster's vendor demo constants."""

    device: Annotated[
        str, Meta(description="Device name, see mimics devices; NAME:ADDRESS where it has an address")
    ] = "simulated_hapticmaster"
    settings: Annotated[dict[str, Any], Meta(description="Settings of a plug-in, see its own guide")] = msgspec.field(
        default_factory=dict
    )
    buttons: Annotated[
        dict[str, ButtonCommand],
        Meta(description="Command of each of the device's buttons by its name; '' for none; absent: the device's own"),
    ] = msgspec.field(default_factory=dict)
    robot_to_world: Annotated[RobotToWorld, Meta(description="Pose of the robot in the world")] = msgspec.field(
        default_factory=RobotToWorld
    )
    stroke: Annotated[Arm, Meta(description="Stroke of the radial axis, q1r [m]")] = 0.36
    offset: Annotated[Reach, Meta(description="Distance from the axis to the retracted arm, l_off [m]")] = 0.28
    axis_offset: Annotated[Arm | None, Meta(description="d1 of equation (1) [m]; absent: stroke / 2 + offset")] = None
    joint_min: Annotated[
        Joints | None, Meta(description="Lower limit per joint [m, rad]; absent: the device's own")
    ] = None
    joint_max: Annotated[
        Joints | None, Meta(description="Upper limit per joint [m, rad]; absent: the device's own")
    ] = None
    masses: Annotated[Masses, Meta(description="Moving masses of the simulator per axis [kg, kg m^2, kg]")] = (
        4.0,
        1.2,
        5.0,
    )
    servo_bandwidth_hz: Annotated[Frequency, Meta(description="Bandwidth of the simulator's velocity servo [Hz]")] = (
        60.0
    )
    delay_ticks: Annotated[int, Meta(ge=0, le=50, description="Delay line of the simulator [ticks of 1 ms]")] = 1
    sensor_noise: Annotated[Force, Meta(description="Standard deviation of the simulated force sensor [N]")] = 0.01
    sensor_quantum: Annotated[Force, Meta(description="Resolution of the simulated force sensor [N]")] = 0.01
    force_limit: Annotated[
        PositiveForce, Meta(description="Limit of the simulated drives, and range of the sensor [N]")
    ] = 250.0
    velocity_limit: Annotated[
        Rates | None, Meta(description="Limit of commands per joint [m/s, rad/s]; absent: the device's own")
    ] = None
    acceleration_limit: Annotated[
        Rates | None, Meta(description="Limit of their rate per joint [m/s^2, rad/s^2]; absent: the device's own")
    ] = None


@component("patient", limit=100, once=True)
class Patient(Component, frozen=True):
    """The simulated person on the simulated robot; absent fields come from the preset."""

    preset: Annotated[Literal["healthy", "moderate", "severe"], Meta(description="Degree of impairment")] = "healthy"
    intent: Annotated[bool, Meta(description="False: the arm is passive and never completes")] = True
    visits: Annotated[
        Visits,
        Meta(description="Entities reached for in turn in a scene without code; absent: paths, else objects"),
    ] = ()
    arm_mass: Annotated[Mass | None, Meta(description="Mass at the hand [kg], usually 0.5-2.5")] = None
    arm_damping: Annotated[Damping | None, Meta(description="Damping at the hand [N s/m], usually 5-40")] = None
    arm_stiffness: Annotated[Stiffness | None, Meta(description="Stiffness at the hand [N/m], usually 100-800")] = None
    speed: Annotated[Speed | None, Meta(description="Peak speed of a voluntary movement [m/s]")] = None
    reach: Annotated[Arm | None, Meta(description="Length of one minimum-jerk movement [m]")] = None
    aim_error: Annotated[Reach | None, Meta(description="Standard deviation of a movement's end point [m]")] = None
    reaction: Annotated[Seconds | None, Meta(description="Pause before the next movement [s]")] = None
    tremor: Annotated[Force | None, Meta(description="Amplitude of the tremor force [N]")] = None
    tremor_hz: Annotated[Frequency | None, Meta(description="Frequency of the tremor [Hz], usually 4-8")] = None
    grasp: Annotated[Force | None, Meta(description="Mean grasp force [N]")] = None
    grasp_variation: Annotated[Force | None, Meta(description="Standard deviation of the grasp force [N]")] = None
    strength: Annotated[PositiveForce | None, Meta(description="Largest grasp force [N]")] = None
    release: Annotated[_Opening | None, Meta(description="Time in which the hand opens [s]")] = None
    range_of_motion: Annotated[
        _Ranges | None,
        Meta(
            description="How far the hand gets from where it rests: to the right, left, up, down, forwards, back [m]; "
            "absent: as far as the device"
        ),
    ] = None
    ease: Annotated[Share | None, Meta(description="Share of that range within which a movement is comfortable")] = None
    hearing_left: Annotated[
        _Level | None, Meta(description="Softest level that is perceived from the left [dB, 0 as authored]")
    ] = None
    hearing_right: Annotated[_Level | None, Meta(description="Softest level that is perceived from the right [dB]")] = (
        None
    )
    letter: Annotated[
        _Letter | None, Meta(description="Height of the smallest letter that is read [px of a picture 720 px high]")
    ] = None
    mirrored: Annotated[bool, Meta(description="True: random movements are those of the mirror image")] = False


@component("next_mark")
class NextMark(Component, frozen=True):
    """A mark over the point that is the task's goal, else the next of the entities that `patient` names, in turn.

    It is hidden where there is neither.
    """

    above: Annotated[Reach, Meta(description="Height over the top of the entity's body [m]")] = 0.03
    within: Annotated[Reach, Meta(description="Distance to the body's outline that counts as reached [m]")] = 0.02


@component("admittance", limit=100, once=True)
class Admittance(Component, frozen=True):
    """Admittance control (D2.1 equations 6, 7): the person moves a virtual mass, the robot follows it."""

    mass: Annotated[Mass, Meta(description="Virtual mass [kg]; below that of hand and handle it is unstable")] = 3.0
    damping: Annotated[Damping, Meta(description="Virtual damping [N s/m]")] = 5.0
    max_acceleration: Annotated[Acceleration, Meta(description="Maximum acceleration of the virtual mass [m/s^2]")] = (
        20.0
    )
    max_velocity: Annotated[Speed, Meta(description="Maximum velocity of the command [m/s]")] = 0.8
    max_joint_acceleration: Annotated[
        Rates | None,
        Meta(description="Maximum per joint [m/s^2, rad/s^2], the last for all behind; absent: the robot's"),
    ] = None
    max_joint_velocity: Annotated[
        Rates | None,
        Meta(description="Maximum per joint [m/s, rad/s], likewise; the form seed clamps every joint on its own"),
    ] = None
    form: Annotated[
        Literal["auto", "cartesian", "polar", "seed"],
        Meta(
            description="Cartesian, polar with coupling terms, or as printed in D2.1 per axis; "
            "auto: the planner (mimics explain), which never takes the printed one"
        ),
    ] = "auto"


@component("impedance", limit=100, once=True)
class Impedance(Component, frozen=True):
    """Impedance control: a device that takes forces renders the virtual force; inertia and gravity are its own."""

    damping: Annotated[Damping, Meta(description="Viscosity rendered with every force [N s/m]")] = 1.0
    device_damping: Annotated[
        Damping, Meta(description="Friction of the device, counted on in the live stability limit [N s/m]")
    ] = 0.0
    drive_stiffness: Annotated[
        Stiffness, Meta(description="Stiffness of the spring that drives the device to a trial's start [N/m]")
    ] = 600.0
    drive_damping: Annotated[Damping, Meta(description="Damping of that drive [N s/m]")] = 20.0
    drive_force: Annotated[PositiveForce, Meta(description="Force limit of that drive [N]")] = 10.0


@component("controller", limit=100, once=True)
class Controller(Component, frozen=True):
    """Controller while the person moves the robot, instead of admittance or impedance control: one by name."""

    name: Annotated[str, Meta(description="Name of the controller, built in or of a plug-in")]
    parameters: Annotated[
        dict[str, _Parameter | _Parameters], Meta(description="Its parameters by name; as its docstring lists")
    ] = msgspec.field(default_factory=dict)
    hard_object: Annotated[
        str | None,
        Meta(
            description="Of a gait orthosis: entity whose mesh, cut by the plane of the leg that explores, is the hard "
            "object; absent: as its parameters say"
        ),
    ] = None


@component("joint_pd", limit=100, once=True)
class JointPd(Component, frozen=True):
    """PD control of the joints (D2.1 equation 5), drives the robot to a trial's start."""

    kp: Annotated[Gains, Meta(description="Gain per joint [1/s], the last for all behind")] = (4.0, 4.0, 4.0)
    kd: Annotated[Gains, Meta(description="Gain per joint [-], below 1")] = (0.1, 0.1, 0.1)


@component("world_pd", limit=100, once=True)
class WorldPd(Component, frozen=True):
    """PD control to a position (D2.1 4.2.6): straight, or as printed by inverse kinematics and joint PD."""

    kp: Annotated[Gains, Meta(description="Gain per axis; form joints: per joint [1/s]")] = (4.0, 4.0, 4.0)
    kd: Annotated[Gains, Meta(description="Likewise [-], below 1")] = (0.1, 0.1, 0.1)
    form: Annotated[
        Literal["straight", "joints"],
        Meta(description="straight: along the axes by the inverse Jacobian; joints: inverse kinematics, then joint PD"),
    ] = "straight"


@component("ball", limit=100)
class Ball(Component, frozen=True):
    """The ball that marks the hand; grasping makes it smaller."""

    radius_min: Annotated[Arm, Meta(description="Radius at full grasp [m]")] = 0.012
    radius_max: Annotated[Arm, Meta(description="Radius at no grasp [m]")] = 0.030
    grasp_force_full: Annotated[PositiveForce, Meta(description="Grasp force that makes it smallest [N]")] = 20.0


@component("safety", limit=100, once=True)
class Safety(Component, frozen=True):
    """Limits and thresholds of the haptic loop. Research software: no substitute for an independent hardware stop."""

    force_limit: Annotated[float, Meta(gt=0, le=500, description="Limit of the virtual force on the person [N]")] = 60.0
    force_rate_limit: Annotated[
        float, Meta(gt=0, le=1e6, description="Limit of its rise [N/s]; a fall is not limited")
    ] = 2000.0
    velocity_limit: Annotated[
        float, Meta(gt=0, le=10, description="Measured velocity beyond which SAFE_STOP follows [m/s]")
    ] = 1.2
    drive_speed: Annotated[
        float,
        Meta(gt=0, le=0.25, description="Limit of the speed at which the robot drives to a start on its own [m/s]"),
    ] = 0.1
    measured_force_limit: Annotated[
        float,
        Meta(gt=0, le=1e4, description="Measured force beyond which SAFE_STOP follows after stale_stop_s [N]"),
    ] = 250.0
    workspace_margin: Annotated[Share, Meta(description="Margin beyond the joint limits before SAFE_STOP [m, rad]")] = (
        0.01
    )
    ramp_time_s: Annotated[float, Meta(ge=0, le=60, description="Soft start, 0 to full force [s]")] = 0.5
    ramp_force: Annotated[
        PositiveForce, Meta(description="The force must be below this to begin the soft start [N]")
    ] = 5.0
    late_hold_s: Annotated[
        float, Meta(gt=0, le=1, description="Lateness beyond which a tick is counted and its output held [s]")
    ] = 0.002
    late_damp_s: Annotated[
        float,
        Meta(gt=0, le=1, description="Lateness beyond which DEGRADED follows: force ramped down with damping [s]"),
    ] = 0.010
    late_stop_s: Annotated[
        float,
        Meta(
            gt=0,
            le=1,
            description="Lateness beyond which SAFE_STOP follows [s]; DEGRADED for a simulated device or a mouse",
        ),
    ] = 0.050
    missed_stop: Annotated[int, Meta(ge=1, le=1000, description="Missed ticks in a row that do the same")] = 20
    stale_warn_s: Annotated[
        float, Meta(gt=0, le=1, description="Age of device data beyond which it is counted [s]")
    ] = 0.003
    stale_stop_s: Annotated[
        float, Meta(gt=0, le=1, description="Age of device data beyond which SAFE_STOP follows [s]")
    ] = 0.020
    arm_damping: Annotated[
        Damping, Meta(description="Damping of the arm, counted on in the live stability limit [N s/m]; 0: a limp hand")
    ] = 0.0
    power_limit: Annotated[
        float,
        Meta(gt=0, le=1e4, description="Limit of the power of the virtual force, delivered or absorbed, |F v| [W]"),
    ] = 60.0
    position_jump: Annotated[
        Reach,
        Meta(description="Distance beyond what velocity_limit allows in the time passed, before SAFE_STOP [m]"),
    ] = 0.001
    energy_limit: Annotated[
        float, Meta(gt=0, le=100, description="Energy one contact may generate before SAFE_STOP [J]")
    ] = 1.0
    stiffness_cap: Annotated[
        Literal["cap", "warn"],
        Meta(
            description="A contact stiffer than stable at the measured period and delay is softened, or only reported"
        ),
    ] = "cap"
    cap_margin: Annotated[
        float, Meta(ge=0, le=10, description="Stability margin that a softened contact keeps [-]")
    ] = 0.2
    passivity: Annotated[
        bool, Meta(description="True: energy generated by a contact is dissipated; it is counted in any case")
    ] = True
    passivity_damping: Annotated[Damping, Meta(description="Limit of the damping that dissipates it [N s/m]")] = 300.0
    tank_size: Annotated[
        float, Meta(ge=0, le=1e3, description="Energy that assistance, effects and moving objects can draw on [J]")
    ] = 5.0
    tank_refill: Annotated[float, Meta(ge=0, le=1e3, description="Constant power into that tank [W]")] = 1.0
    tank_return: Annotated[
        Share, Meta(description="Share of the power dissipated by virtual damping that flows into it [-]")
    ] = 0.9
