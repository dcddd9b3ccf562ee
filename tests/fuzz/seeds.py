"""Writes the seeds of the binary formats, byte by byte from their specifications, and of the texts from the files that
ship with the project, into a folder each: seeds.py FOLDER. They are where the fuzzers begin; what those found worth
keeping lies in corpus/."""
import json
import pathlib
import struct
import sys
import zlib

ROOT = pathlib.Path(__file__).resolve().parents[2]
out = pathlib.Path(sys.argv[1])


def crc(data):
    value = 0xFFFF
    for byte in data:
        value ^= byte
        for _ in range(8):
            value = value >> 1 ^ 0xA001 if value & 1 else value >> 1
    return struct.pack("<H", value)


def keep(target, name, data):
    folder = out / target
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(data if isinstance(data, bytes) else data.encode())


def counted(*parts):
    return b"".join(bytes([len(part)]) + part for part in parts)


# modbus_pdu: kind, first (2), count, then the reply's PDU.
keep("modbus_pdu", "read", bytes([0, 0, 7, 2, 3, 4, 0x12, 0x34, 0x56, 0x78]))
keep("modbus_pdu", "write_one", bytes([1, 0, 7, 1, 6, 0, 7, 0x12, 0x34]))
keep("modbus_pdu", "write_several", bytes([2, 0, 7, 3, 16, 0, 7, 0, 3]))
keep("modbus_pdu", "write_and_read", bytes([3, 0, 7, 1, 23, 2, 0xAB, 0xCD]))
keep("modbus_pdu", "exception", bytes([0, 0, 7, 2, 0x83, 2]))

# modbus_tcp: kind, count - 1, then the stream: transaction, protocol, length, unit, PDU.
for kind, pdu in enumerate(([3, 4, 0, 1, 0, 2], [16, 0, 7, 0, 2], [23, 4, 0, 1, 0, 2])):
    stream = b"".join(struct.pack(">HHHB", k, 0, 1 + len(pdu), 1) + bytes(pdu) for k in (1, 2, 3))
    keep("modbus_tcp", f"kind_{kind}", bytes([kind, 1]) + stream)
keep("modbus_tcp", "exception", bytes([0, 1]) + struct.pack(">HHHBBB", 1, 0, 3, 1, 0x83, 4))
keep("modbus_tcp", "other_transaction", bytes([0, 1]) + struct.pack(">HHHBBBHH", 9, 0, 7, 1, 3, 4, 1, 2))

# modbus_rtu: count - 1, whether a CRC is added, then unit and PDU.
for name, frame in {"read": [17, 3, 4, 0, 1, 0, 2], "exception": [17, 0x83, 2], "other_unit": [18, 3, 4, 0, 1, 0, 2],
                    "write": [17, 16, 0, 7, 0, 2], "both": [17, 23, 4, 1, 2, 3, 4]}.items():
    keep("modbus_rtu", name, bytes([1, 1] + frame))
    keep("modbus_rtu", name + "_whole", bytes([1, 0] + frame) + crc(bytes(frame)))

# stage_state: per step a byte (odd: a command), outcome byte, changes.
keep("stage_state", "looks", bytes([0, 0, 0] * 6))
keep("stage_state", "lost", bytes([0, 0xC0, 0xC1, 0xC2, 0, 0, 0]))
keep("stage_state", "other_identity", bytes([0, 0, 1, 1, 0x12, 0x34] * 3))
for command in range(6):
    keep("stage_state", f"command_{command}", bytes([1, 0, 5, command, 0, 0, 1, 64, 0, 0, 0, 0, 0, 0, 0, 0xC0, 1, 0]))

# usbtmc_message: tag, most (2), then the transfer.
text = b"1.25e-4\n"
keep("usbtmc_message", "in", bytes([5, 4, 0]) + struct.pack("<BBBxIB3x", 2, 5, 250, len(text), 1) + text)
keep("usbtmc_message", "out", bytes([5, 4, 0]) + struct.pack("<BBBxIB3x", 1, 5, 250, 6, 1) + b"READ?\n\0\0")
keep("usbtmc_message", "request", bytes([5, 4, 0]) + struct.pack("<BBBxIBB2x", 2, 6, 249, 1024, 2, 10))
keep("usbtmc_message", "capabilities",
     bytes([5, 4, 0]) + bytes([1, 0, 0, 1, 4, 1] + [0] * 6 + [0, 1, 7, 15] + [0] * 8))
keep("usbtmc_message", "setup", bytes([5, 4, 0, 0xA1, 128, 2, 0, 0, 0, 3, 0]))

for name, line in {"number": "+1.250000E-04\n", "nan": "9.91E37", "overload": "-9.9E37", "tiny": "1e-400", "flag": "ON",
                   "identity": "maker,model,RAD-1,1.0", "quoted": "\"say \"\"no\"\"\"", "entry": "-113,\"Undefined header\"",
                   "command": "SENS:CORR:WAV 568;:READ?", "whole": "32767"}.items():
    keep("scpi_text", name, line)

# radiometer: whether there is an Interrupt-IN, bytes in a transfer - 1, then calls and what becomes of each transfer.
keep("radiometer", "read", bytes([0, 200, 4]) + bytes(200))
keep("radiometer", "interrupt", bytes([1, 200, 4]) + bytes(200))
keep("radiometer", "parts", bytes([0, 2, 4]) + bytes(300))
keep("radiometer", "zero", bytes([0, 200, 2]) + bytes(300))
keep("radiometer", "apply", bytes([0, 200, 1, 10, 2]) + bytes(300))
keep("radiometer", "sample", bytes([0, 200, 4]) + bytes(68) + bytes([3]) + counted(b"1e300\n") + bytes(100))

# frame: width + 1, height + 1, full scale (2), centre x, y, radius in quarters from -8 on (2 each), missing, pixels (2).
def frame(width, height, x, y, r, pixels):
    head = bytes([width + 1, height + 1]) + struct.pack(">H3H", 4095, *(int((v + 8) * 4) for v in (x, y, r)))
    return head + b"\0" + struct.pack(f">{len(pixels)}H", *pixels)


keep("frame", "odd", frame(7, 5, 3, 2, 2, [100 + 37 * k % 64 for k in range(35)]))
keep("frame", "line", frame(9, 1, 4, 0, 0.25, [4095] * 9))
keep("frame", "bright", frame(16, 16, 7.5, 7.5, 6, [65535, 65534] * 128))
keep("frame", "empty", frame(0, 0, 0, 0, 1, []))

for path in [*(ROOT / "packaging").glob("*.toml"), *(ROOT / "sim/scenes").glob("*.toml")]:
    name = path.name.split(".")[0]
    target = {"plan": "plan_toml", "instrument": "instrument_toml"}.get(name, "scene_toml")
    keep(target, name, path.read_bytes())

# api_text: what, then an event stream in counted pieces, a request's head, or a JSON body.
event = b'id: 4\nevent: scan.state\ndata: {"number":4,"kind":"scan.state","kind_version":1,"scan":1,"who":"local","utc":"2026-01-01T00:00:00.000Z","data":{}}\n\n'
keep("api_text", "events", b"\0" + counted(event[:40], event[40:]))
for path in ("/api/v1/scans/3/points", "/api/v1/stop", "/api/v1/plans:check", "/api/v1/scans"):
    head = f"POST\n{path}\nhost:localhost:8080\ncontent-type:application/json\ncontent-length:12\norigin:http://localhost:8080\n"
    keep("api_text", "head" + path.replace("/", "_").replace(":", "_"), b"\1" + head.encode())
keep("api_text", "get", b"\1GET\n/api/v1/scans/3\nhost:127.0.0.1:8080\n")
for name, body in {"move": '{"theta_i_deg": 30.5, "source_shutter_open": true}', "pause": '{"now": true, "reason": "door"}',
                   "plan": '{"plan": "[scan]", "plan_file": "a.toml", "parts": {"a": "b"}}', "nothing": "{}",
                   "problem": '{"type": "about:blank", "title": "x", "status": 422, "code": "out-of-limits", "device": "stage"}',
                   "brdf": '{"values": [{"point": 1, "brdf_per_sr": 0.3, "status": "accepted"}], "next_after": 1}'}.items():
    keep("api_text", name, b"\2" + body.encode())

# modbus_request: milliseconds (2), counted PDU.
def requests(*pdus):
    return b"".join(b"\0\x10" + counted(bytes(pdu)) for pdu in pdus)


keep("modbus_request", "read", requests([3, 0, 0, 0, 100]))
keep("modbus_request", "write", requests([6, 0, 128, 0, 1], [16, 0, 128, 0, 2, 4, 0, 1, 0, 2]))
keep("modbus_request", "both", requests([23, 0, 0, 0, 100, 0, 0, 0, 1, 2, 0, 5]))
keep("modbus_request", "unknown", requests([1, 0, 0, 0, 1], [0x2B, 14, 1, 0], [3, 0xFF, 0xFF, 0, 2]))

# gvcp_request: length (2), datagram.
def gvcp(*commands):
    parts = []
    for command, payload in commands:
        data = struct.pack(">BBHHH", 0x42, 1, command, len(payload), 7) + payload
        parts.append(struct.pack(">H", len(data)) + data)
    return b"".join(parts)


control = (0x82, struct.pack(">II", 0x0A00, 2))
keep("gvcp_request", "discover", gvcp((2, b"")))
keep("gvcp_request", "read", gvcp((0x80, struct.pack(">II", 0x0A00, 0x4004)), (0x84, struct.pack(">II", 0x10000, 512))))
keep("gvcp_request", "write", gvcp(control, (0x82, struct.pack(">II", 0x4000, 1)), (0x86, struct.pack(">Id", 0x4030, 2000.0))))
keep("gvcp_request", "trigger",
     gvcp(control, (0x82, struct.pack(">IIIIII", 0x401C, 1, 0x4000, 1, 0x4028, 1)), (0x40, struct.pack(">HHII", 0, 1, 0, 3))))

# usbtmc_device: milliseconds, which, then its own.
def message(text):
    return b"\5\5" + counted(text)


out_message = struct.pack("<BBBxIB3x", 1, 5, 250, 6, 1) + b"READ?\n\0\0"
in_request = struct.pack("<BBBxIBB2x", 2, 6, 249, 1024, 0, 0)
keep("usbtmc_device", "read", b"\5\1" + counted(out_message) + b"\5\1" + counted(in_request) + b"\x20\2\4\0")
keep("usbtmc_device", "status", b"\5\0" + bytes([0xA1, 128, 2, 0, 0, 0, 3, 0]) + b"\5\3")
keep("usbtmc_device", "descriptors", b"\5\0" + bytes([0x80, 6, 0, 1, 0, 0, 18, 0]) + b"\5\0" + bytes([0x80, 6, 0, 2, 0, 0, 64, 0]))
keep("usbtmc_device", "clear", b"\5\0" + bytes([0xA1, 5, 0, 0, 0, 0, 1, 0]) + b"\5\0" + bytes([0xA1, 6, 0, 0, 0, 0, 2, 0]))
for k, text in enumerate((b"*IDN?\n", b"SENS:CORR:WAV 633;:SENS:CORR:WAV?", b"SENS:POW:RANG 1e-3;RANG?", b"CONF:POW;:CONF?",
                          b"SENS:CORR:COLL:ZERO;*OPC?", b"NONSENSE 1,2;SYST:ERR?", b"sense:average:count 4;count?", b"READ?;READ?")):
    keep("usbtmc_device", f"message_{k}", message(text) + message(b"SYST:ERR?"))

# pixels: odd is packed pixels of a tape; even a format's index, then its bytes.
for k in range(9):
    keep("pixels", f"format_{k}", bytes([0, k]) + bytes((37 * j + k) % 256 for j in range(31)))
keep("pixels", "packed", bytes([1, 0, 8]) + zlib.compress(bytes(range(16))))

# tape: odd is payloads in counted pieces (2), even a file as it is.
keep("tape", "turn", bytes([1]) + struct.pack(">H", 19) + bytes([2, 1, 0]) + bytes(16))
keep("tape", "file", bytes([0]) + b"GONIOTAP\r\n\x1a\1" + struct.pack("<II", 2, zlib.crc32(b"\6\0")) + b"\6\0")

# brdf_file: a small file of each format, by its description; MERL's begins with its three lengths.
GRID = [(30, theta, phi, 0.1 + 0.01 * theta - 0.001 * phi) for theta in (0, 20, 40) for phi in (0, 90, 180)]
keep("brdf_file", "csv", "# by hand\ntheta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,f_per_sr,U_per_sr,k,wavelength_nm,flags\n"
     + "".join(f"{i},0,{r},{p},{f:.3f},0.01,2,550,{'weak|odd' if r == 20 else ''}\n" for i, r, p, f in GRID))
keep("brdf_file", "astm", "ASTM E1392-96(2002)\nNUM_POINTS 9\nVARS theta_i,phi_i,theta_s,phi_s,550nm\n"
     + "".join(f"{i / 57.3:.5f},0,{r / 57.3:.5f},{p / 57.3:.5f},{f:.3f}\n" for i, r, p, f in GRID))
for name in ("ISOTROPIC_TV_TL_DPHI", "RUSIN_TH_TD_PD"):
    keep("brdf_file", "alta_" + name.lower(), f"#SAMPLE \"x\"\n#DIM 3 1\n#VS 1\n#PARAM_IN {name}\n#PARAM_OUT INV_STERADIAN_COSINE_FACTOR\n"
         + "".join(f"{i / 57.3:.5f} {r / 57.3:.5f} {p / 57.3:.5f} {f:.3f} 0.01\n" for i, r, p, f in GRID))
keep("brdf_file", "alta_plane", "#DIM 3 1\n#VS 0\n#PARAM_IN ISOTROPIC_TL_TV_PROJ_DPHI\n#PARAM_OUT INV_STERADIAN\n"
     + "".join(f"0.5 {x / 10} 0 {1 + x}\n" for x in range(-12, 13, 3)))
keep("brdf_file", "alta_colour", "#DIM 6 3\n#VS 2 0 0\n#PARAM_IN CARTESIAN\n#PARAM_OUT RGB_COLOR\n0 0 1 0 0 1 1 2 3 0.9 1.1\n0 1 0 0 0 1 1 2 3 0.9 1.1\n")
keep("brdf_file", "zemax", "# Sample: x\nSource\tMeasured\nSymmetry\tPlaneSymmetrical\nSpectralContent\tMonochrome\nScatterType\tBRDF\n"
     "SampleRotation\t1\n0\nAngleOfIncidence\t2\n0\t30\nScatterAzimuth\t3\n0\t90\t180\nScatterRadial\t3\n0\t20\t60\nMonochrome\nDataBegin\n"
     + "TIS\t0.3\n.1\t.2\t.3\n.1\t.2\t.3\n.1\t.2\t.3\n" * 2 + "DataEnd\n")
ssdd = "VERSION 0.2\nDATA_TYPE brdf\nCOLOR_MODEL {}\nPARAM_TYPE {}_coordinate_system\nREDUCTION_TYPE bilateral_symmetry\nPARAM0_LIST 0 30\n" \
       "PARAM2_LIST 0 40\nPARAM3_LIST 0 90\nDATA {}\n"
for kind in ("spherical", "specular", "half_difference"):
    keep("brdf_file", "ssdd_" + kind, ssdd.format("monochrome", kind, "ascii") + "".join(f"{k}\n" for k in range(8)))
keep("brdf_file", "ssdd_binary", ssdd.format("rgb", "spherical", "binary").encode() + struct.pack("<24f", *range(24)))
keep("brdf_file", "merl", struct.pack("<3i4d", 90, 90, 180, 1, 2, 3, 4))


def tensor(fields):
    places, data = 18 + sum(2 + len(name) + 11 + 8 * len(shape) for name, _, shape, _ in fields), b""
    head = b"tensor_file\0\1\0" + struct.pack("<I", len(fields))
    for name, kind, shape, values in fields:
        data += bytes(-(places + len(data)) % 8)
        head += struct.pack("<H", len(name)) + name.encode() + struct.pack(f"<HBQ{len(shape)}Q", len(shape), kind, places + len(data), *shape)
        data += bytes(values) if kind == 1 else struct.pack(f"<{len(values)}f", *values)
    return head + data


keep("brdf_file", "rgl", tensor([("description", 1, [4], b"blue"), ("phi_i", 10, [1], [0]), ("theta_i", 10, [2], [0, 0.5]),
                                 ("ndf", 10, [2, 2], [4] * 4), ("sigma", 10, [2, 2], [1] * 4), ("vndf", 10, [1, 2, 2, 2], [1, 2] * 4),
                                 ("wavelengths", 10, [1], [550]), ("spectra", 10, [1, 2, 1, 3, 3], [0.1] * 18)]))

columns = {"theta_i": [g[0] for g in GRID], "phi_i": [0] * len(GRID), "theta_r": [g[1] for g in GRID], "phi_r": [g[2] for g in GRID]}
bird = {name: {"unit": "deg", "values": values} for name, values in columns.items()}
bird["wavelength_i"] = {"unit": "nm", "values": [550] * len(GRID)}
bird["BRDF"] = {"unit": "sr^-1", "values": [round(g[3], 3) for g in GRID]}
keep("brdf_file", "bird", json.dumps({"metadata": {"sample": {"name": "x"}}, "data": bird}))
