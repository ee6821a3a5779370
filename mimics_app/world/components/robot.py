"""Component types of the robot, the person on it, and the tunnel (D2.1 4.2). SI units, angles radians.

Frames: `world` is the scene's, `robot` the HapticMaster's WCS (x radial, y lateral, z up).
Defaults of `Safety` are the loop's own, also in a scene without that component; the report states what ran.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta

from mimics_app.world.components.registry import Component, component

__all__ = [
    "Admittance",
    "Ball",
    "Impedance",
    "JointPd",
    "Patient",
    "Robot",
    "RobotToWorld",
    "Safety",
    "Tunnel",
    "WorldPd",
]

Point = tuple[float, float, float]
NotNegative = Annotated[float, Meta(ge=0)]
Positive = Annotated[float, Meta(gt=0)]
Triple = tuple[NotNegative, NotNegative, NotNegative]
Row = tuple[float, float, float]


@component("tunnel")
class Tunnel(Component, frozen=True):
    """The tunnel of D2.1 4.2.10: a B-spline bisector, a radius along it, and the forces of its wall."""

    control_points: Annotated[
        tuple[Point, ...] | None, Meta(description="Of the cubic B-spline that is the bisector, world [m]; at least 4")
    ] = None
    path_file: Annotated[
        str | None,
        Meta(description="Recorded path to fit instead: .csv (x,y,z columns) or .json ([[x,y,z],..]), world [m]"),
    ] = None
    basis_functions: Annotated[
        Annotated[int, Meta(ge=4, le=99)] | None, Meta(description="Basis functions fitted to `path_file`")
    ] = None
    radius: Annotated[
        NotNegative | tuple[NotNegative, ...], Meta(description="[m]; or several, evenly spread from start to end")
    ] = 0.04
    radius_scale: Annotated[float, Meta(ge=0, description="Factor on `radius`; 0 keeps the ball on the bisector")] = 1.0
    stiffness: Annotated[float, Meta(ge=0, description="Of the wall [N/m]")] = 1500.0
    damping: Annotated[float, Meta(ge=0, description="Of the wall, along its normal [N s/m]")] = 10.0
    drag: Annotated[float, Meta(ge=0, description="Along the tunnel [N s/m]")] = 2.0
    drag_growth: Annotated[
        float, Meta(ge=0, description="Added to drag per metre the ball is larger than the tunnel [N s/m per m]")
    ] = 2000.0
    centring: Annotated[float, Meta(ge=0, description="Assistance towards the bisector [N/m]")] = 0.0
    advance: Annotated[float, Meta(ge=0, description="Assistance along the tunnel towards its end [N]")] = 0.0


class RobotToWorld(Component, frozen=True):
    """Where the robot's WCS stands in the world."""

    rotation: Annotated[tuple[Row, Row, Row], Meta(description="R_world_from_robot, rows; a rotation")] = (
        (0.0, 1.0, 0.0),
        (0.0, 0.0, 1.0),
        (1.0, 0.0, 0.0),
    )
    translation: Annotated[Point, Meta(description="WCS origin in the world [m]")] = (0.0, 0.0, 0.0)


@component("robot")
class Robot(Component, frozen=True):
    """The robot, or what stands in for it. Workspace figures are the HapticMaster's vendor demo constants."""

    device: Annotated[
        str, Meta(description="A name that mimics devices lists, with NAME:ADDRESS where it has an address")
    ] = "simulated_hapticmaster"
    settings: Annotated[dict[str, Any], Meta(description="Settings of a plug-in, as its own guide says")] = (
        msgspec.field(default_factory=dict)
    )
    robot_to_world: Annotated[RobotToWorld, Meta(description="Where the robot stands")] = msgspec.field(
        default_factory=RobotToWorld
    )
    stroke: Annotated[float, Meta(gt=0, description="Of the radial axis, q1r [m]")] = 0.36
    offset: Annotated[float, Meta(ge=0, description="Axis to the retracted arm, l_off [m]")] = 0.28
    axis_offset: Annotated[Positive | None, Meta(description="d1 of equation (1) [m]; absent: stroke / 2 + offset")] = (
        None
    )
    joint_min: Annotated[Row, Meta(description="q1 [m], q2 [rad], q3 [m]")] = (-0.18, -0.5, -0.20)
    joint_max: Annotated[Row, Meta(description="q1 [m], q2 [rad], q3 [m]")] = (0.18, 0.5, 0.20)
    masses: Annotated[Triple, Meta(description="Moving masses of the simulator per axis [kg, kg m^2, kg]")] = (
        4.0,
        1.2,
        5.0,
    )
    servo_bandwidth_hz: Annotated[float, Meta(gt=0, description="Of the simulator's velocity servo [Hz]")] = 60.0
    delay_ticks: Annotated[int, Meta(ge=0, le=50, description="Delay line of the simulator [ticks of 1 ms]")] = 1
    sensor_noise: Annotated[float, Meta(ge=0, description="Of the simulated force sensor, standard deviation [N]")] = (
        0.01
    )
    sensor_quantum: Annotated[float, Meta(ge=0, description="Resolution of the simulated force sensor [N]")] = 0.01
    force_limit: Annotated[float, Meta(gt=0, description="Of the simulated drives, and range of its sensor [N]")] = (
        250.0
    )
    velocity_limit: Annotated[Triple, Meta(description="Of the simulated axes [m/s, rad/s, m/s]")] = (1.0, 2.0, 1.0)


@component("patient")
class Patient(Component, frozen=True):
    """The simulated person on the simulated robot; what is absent comes from the preset."""

    preset: Annotated[Literal["healthy", "moderate", "severe"], Meta(description="How impaired")] = "healthy"
    intent: Annotated[bool, Meta(description="False: the arm is passive and never completes")] = True
    visits: Annotated[
        tuple[str, ...],
        Meta(description="Entities reached for in turn in a scene without code; absent: paths, else objects"),
    ] = ()
    arm_mass: Annotated[Positive | None, Meta(description="At the hand [kg], usually 0.5-2.5")] = None
    arm_damping: Annotated[NotNegative | None, Meta(description="At the hand [N s/m], usually 5-40")] = None
    arm_stiffness: Annotated[NotNegative | None, Meta(description="At the hand [N/m], usually 100-800")] = None
    speed: Annotated[Positive | None, Meta(description="Peak speed of a voluntary movement [m/s]")] = None
    reach: Annotated[Positive | None, Meta(description="Length of one minimum-jerk movement [m]")] = None
    aim_error: Annotated[NotNegative | None, Meta(description="Standard deviation of a movement's end point [m]")] = (
        None
    )
    reaction: Annotated[NotNegative | None, Meta(description="Pause before the next movement [s]")] = None
    tremor: Annotated[NotNegative | None, Meta(description="Amplitude of the tremor force [N]")] = None
    tremor_hz: Annotated[Positive | None, Meta(description="Frequency of the tremor [Hz], usually 4-8")] = None
    grasp: Annotated[NotNegative | None, Meta(description="Mean grasp force [N]")] = None
    grasp_variation: Annotated[NotNegative | None, Meta(description="Standard deviation of the grasp force [N]")] = None


@component("admittance")
class Admittance(Component, frozen=True):
    """Admittance control (D2.1 equations 6, 7): the person moves a virtual mass, the robot follows it."""

    mass: Annotated[
        float, Meta(gt=0, description="Virtual mass [kg]; below that of hand and handle it is unstable")
    ] = 3.0
    damping: Annotated[float, Meta(ge=0, description="Virtual damping [N s/m]")] = 5.0
    max_acceleration: Annotated[float, Meta(gt=0, description="Of the virtual mass [m/s^2]")] = 20.0
    max_velocity: Annotated[float, Meta(gt=0, description="Of the command [m/s]")] = 0.8
    form: Annotated[
        Literal["cartesian", "polar", "seed"],
        Meta(description="Cartesian, polar with coupling terms, or as printed in D2.1 per axis"),
    ] = "cartesian"


@component("impedance")
class Impedance(Component, frozen=True):
    """Impedance control: a device that is told forces renders the virtual force; inertia and gravity are its own."""

    damping: Annotated[float, Meta(ge=0, description="Viscosity rendered with every force [N s/m]")] = 1.0
    device_damping: Annotated[
        float, Meta(ge=0, description="Friction of the device, counted on in the live stability limit [N s/m]")
    ] = 0.0
    drive_stiffness: Annotated[
        float, Meta(gt=0, description="Of the spring that draws the device to a trial's start [N/m]")
    ] = 600.0
    drive_damping: Annotated[float, Meta(ge=0, description="Of the damper beside it [N s/m]")] = 20.0
    drive_force: Annotated[float, Meta(gt=0, description="Most that both do [N]")] = 10.0


@component("joint_pd")
class JointPd(Component, frozen=True):
    """PD control of the joints (D2.1 equation 5), drives the robot to a trial's start."""

    kp: Annotated[Triple, Meta(description="Per joint [1/s]")] = (4.0, 4.0, 4.0)
    kd: Annotated[Triple, Meta(description="Per joint [-], below 1")] = (0.1, 0.1, 0.1)


@component("world_pd")
class WorldPd(Component, frozen=True):
    """PD control along the robot's world axes (D2.1 4.2.6)."""

    kp: Annotated[Triple, Meta(description="Per axis [1/s]")] = (4.0, 4.0, 4.0)
    kd: Annotated[Triple, Meta(description="Per axis [-], below 1")] = (0.1, 0.1, 0.1)


@component("ball")
class Ball(Component, frozen=True):
    """The ball that marks the hand; grasping makes it smaller."""

    radius_min: Annotated[float, Meta(gt=0, description="At full grasp [m]")] = 0.012
    radius_max: Annotated[float, Meta(gt=0, description="At no grasp [m]")] = 0.030
    grasp_force_full: Annotated[float, Meta(gt=0, description="Grasp force that makes it smallest [N]")] = 20.0


@component("safety")
class Safety(Component, frozen=True):
    """Limits and thresholds of the haptic loop. Research software: no substitute for an independent hardware stop."""

    force_limit: Annotated[float, Meta(gt=0, description="Of the virtual force on the person [N]")] = 60.0
    force_rate_limit: Annotated[float, Meta(gt=0, description="Of its rise [N/s]; falling is free")] = 2000.0
    velocity_limit: Annotated[float, Meta(gt=0, description="Measured; beyond it SAFE_STOP [m/s]")] = 1.2
    workspace_margin: Annotated[float, Meta(ge=0, description="Beyond the joint limits before SAFE_STOP [m, rad]")] = (
        0.01
    )
    ramp_time_s: Annotated[float, Meta(ge=0, description="Soft start, 0 to full force [s]")] = 0.5
    ramp_force: Annotated[float, Meta(gt=0, description="The force must be below this to begin the soft start [N]")] = (
        5.0
    )
    late_hold_s: Annotated[float, Meta(gt=0, description="A tick later than this is counted, its output held [s]")] = (
        0.002
    )
    late_damp_s: Annotated[float, Meta(gt=0, description="Later: DEGRADED, force ramped down with damping [s]")] = 0.010
    late_stop_s: Annotated[
        float, Meta(gt=0, description="Later: SAFE_STOP [s]; DEGRADED where the device is simulated or a mouse")
    ] = 0.050
    missed_stop: Annotated[int, Meta(ge=1, description="Missed ticks in a row that do the same")] = 20
    stale_warn_s: Annotated[float, Meta(gt=0, description="Device data older than this is counted [s]")] = 0.003
    stale_stop_s: Annotated[float, Meta(gt=0, description="Older: SAFE_STOP [s]")] = 0.020
    arm_damping: Annotated[
        float, Meta(ge=0, description="Of the arm, counted on in the live stability limit [N s/m]; 0: a limp hand")
    ] = 0.0
    power_limit: Annotated[
        float, Meta(gt=0, description="Of the virtual force, given to the person or taken, |F v| [W]")
    ] = 60.0
    position_jump: Annotated[
        float,
        Meta(ge=0, description="Way beyond what velocity_limit allows in the time passed, before SAFE_STOP [m]"),
    ] = 0.001
    energy_limit: Annotated[float, Meta(gt=0, description="One contact may give before SAFE_STOP [J]")] = 1.0
    stiffness_cap: Annotated[
        Literal["cap", "warn"],
        Meta(description="A contact stiffer than stable at the measured period and delay is softened, or only told"),
    ] = "cap"
    cap_margin: Annotated[float, Meta(ge=0, description="Stability margin that a softened contact keeps [-]")] = 0.2
    passivity: Annotated[
        bool, Meta(description="Whether energy that a contact has made is taken back; it is counted in any case")
    ] = True
    passivity_damping: Annotated[float, Meta(ge=0, description="Most that taking it back may add [N s/m]")] = 300.0
    tank_size: Annotated[
        float, Meta(ge=0, description="Energy that assistance, effects and moving objects can draw on [J]")
    ] = 5.0
    tank_refill: Annotated[float, Meta(ge=0, description="Power that always flows into that tank [W]")] = 1.0
    tank_return: Annotated[
        float, Meta(ge=0, le=1, description="Share of what virtual damping takes that flows into it [-]")
    ] = 0.9
