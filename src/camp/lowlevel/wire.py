"""Unitree's messages and what they mean here: LowCmd_ with its checksum, LowState_."""

from __future__ import annotations

from typing import Any

import numpy as np
from unitree_sdk2py.idl.default import unitree_go_msg_dds__LowCmd_, unitree_go_msg_dds__LowState_
from unitree_sdk2py.utils.crc import CRC

from camp.lowlevel.messages import REMOTE_BYTES, Array, Command, Reading
from camp.lowlevel.motor_order import from_motors, to_motors
from camp.robots.quadruped import NUM_JOINTS

Message = Any  # LowCmd_ or LowState_, whose own annotations of arrays are no types of Python

HEAD = (0xFE, 0xEF)
LOW_LEVEL = 0xFF  # level_flag
SERVO_MODE = 0x01  # of a motor that obeys
NO_POSITION, NO_VELOCITY = 2.146e9, 16000.0  # "leave alone", for the 8 motors that a Go2 does not have


class CommandWriter:
    """Fills one LowCmd_ again and again: making a new one costs more than the rest."""

    def __init__(self) -> None:
        self._checksum = CRC()
        self._message: Message = unitree_go_msg_dds__LowCmd_()
        self._message.head = list(HEAD)
        self._message.level_flag = LOW_LEVEL
        for motor in self._message.motor_cmd:
            motor.mode, motor.q, motor.dq = SERVO_MODE, NO_POSITION, NO_VELOCITY

    def message(self, command: Command) -> Message:
        """The message; the next call overwrites it."""
        columns = (command.target, command.velocity, command.torque, command.kp, command.kd)
        rows = np.stack([to_motors(np.asarray(column)) for column in columns], axis=1).tolist()
        for motor, (position, velocity, torque, kp, kd) in zip(self._message.motor_cmd, rows, strict=False):
            motor.q, motor.dq, motor.tau, motor.kp, motor.kd = position, velocity, torque, kp, kd
        self._message.reserve = command.step
        self._message.crc = self._checksum.Crc(self._message)
        return self._message


class CommandReader:
    """Reads LowCmd_ as the robot does."""

    def __init__(self) -> None:
        self._checksum = CRC()

    def command(self, message: Message) -> Command | None:
        """What the message asks for; None where its checksum is wrong, as the robot ignores it, too."""
        if message.crc != self._checksum.Crc(message):
            return None
        motors = message.motor_cmd[:NUM_JOINTS]
        rows = np.array([[m.q, m.dq, m.tau, m.kp, m.kd] for m in motors], np.float32)
        target, velocity, torque, kp, kd = map(from_motors, rows.T)
        return Command(target, kp, kd, velocity, torque, step=message.reserve)


def reading_of(message: Message) -> Reading | None:
    """What a LowState_ tells; None where a number in it is not finite. Its checksum is not looked at."""
    motors = message.motor_state[:NUM_JOINTS]
    rows = np.array([[m.q, m.dq, m.tau_est] for m in motors], np.float32)
    position, velocity, torque = map(from_motors, rows.T)
    imu = message.imu_state
    reading = Reading(
        time_ms=message.tick,
        joint_position=position,
        joint_velocity=velocity,
        attitude=np.array(imu.quaternion, np.float32),
        angular_velocity=np.array(imu.gyroscope, np.float32),
        joint_torque=torque,
        acceleration=np.array(imu.accelerometer, np.float32),
        remote=bytes(message.wireless_remote[:REMOTE_BYTES]),
        step=message.reserve,
    )
    return reading if reading.finite else None


class StateWriter:
    """Fills one LowState_ again and again."""

    def __init__(self) -> None:
        self._message: Message = unitree_go_msg_dds__LowState_()
        self._message.head = list(HEAD)
        self._message.level_flag = LOW_LEVEL

    def message(self, reading: Reading) -> Message:
        """The message; the next call overwrites it."""
        columns = (reading.joint_position, reading.joint_velocity, reading.joint_torque)
        rows = np.stack([to_motors(column) for column in columns], axis=1).tolist()
        for motor, (position, velocity, torque) in zip(self._message.motor_state, rows, strict=False):
            motor.mode, motor.q, motor.dq, motor.tau_est = SERVO_MODE, position, velocity, torque
        imu = self._message.imu_state
        imu.quaternion = _floats(reading.attitude)
        imu.gyroscope = _floats(reading.angular_velocity)
        imu.accelerometer = _floats(reading.acceleration)
        self._message.wireless_remote = list(reading.remote)
        self._message.tick, self._message.reserve = reading.time_ms, reading.step
        return self._message


def _floats(values: Array) -> list[float]:
    return [float(value) for value in values]
