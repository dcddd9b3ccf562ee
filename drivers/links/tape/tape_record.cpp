#include "drivers/links/tape/tape_record.h"

namespace gonio::drivers {

std::string_view tape_party_name(TapeParty party) {
  switch (party) {
    case TapeParty::Stage:
      return "stage";
    case TapeParty::Halt:
      return "halt line";
    case TapeParty::Detector:
      return "detector";
    case TapeParty::Monitor:
      return "monitor";
    case TapeParty::Sequencer:
      return "sequencer";
    case TapeParty::Store:
      return "store";
  }
  return {};
}

std::string_view tape_call_name(TapeCall call) {
  switch (call) {
    case TapeCall::ReadRegisters:
      return "read registers";
    case TapeCall::WriteRegisters:
      return "write registers";
    case TapeCall::WriteAndRead:
      return "write and read registers";
    case TapeCall::Resync:
      return "drop what the line holds";
    case TapeCall::CameraOpen:
      return "open the camera";
    case TapeCall::CameraClose:
      return "close the camera";
    case TapeCall::CameraIsOpen:
      return "ask whether the camera is open";
    case TapeCall::CameraHasLostControl:
      return "ask whether the camera was lost";
    case TapeCall::CameraSetFormat:
      return "set the format";
    case TapeCall::CameraFormatRead:
      return "read the format";
    case TapeCall::CameraSetExposure:
      return "set the exposure";
    case TapeCall::CameraExposureRead:
      return "read the exposure";
    case TapeCall::CameraTemperature:
      return "read the camera's temperature";
    case TapeCall::CameraStart:
      return "start the stream";
    case TapeCall::CameraStop:
      return "stop the stream";
    case TapeCall::CameraIsStreaming:
      return "ask whether the camera streams";
    case TapeCall::CameraTrigger:
      return "trigger";
    case TapeCall::CameraPop:
      return "look for a frame";
    case TapeCall::UsbOpen:
      return "open the USB device";
    case TapeCall::UsbClose:
      return "close the USB device";
    case TapeCall::UsbIsOpen:
      return "ask whether the USB device is open";
    case TapeCall::UsbInterface:
      return "ask for the USB interface";
    case TapeCall::UsbBulkOut:
      return "bulk out";
    case TapeCall::UsbBulkIn:
      return "bulk in";
    case TapeCall::UsbInterruptIn:
      return "interrupt in";
    case TapeCall::UsbControlIn:
      return "control in";
    case TapeCall::UsbClearHalt:
      return "clear a halted endpoint";
  }
  return {};
}

bool is_a_query(TapeCall call) {
  switch (call) {
    case TapeCall::CameraIsOpen:
    case TapeCall::CameraHasLostControl:
    case TapeCall::CameraIsStreaming:
    case TapeCall::UsbIsOpen:
    case TapeCall::UsbInterface:
      return true;
    default:
      return false;
  }
}

}  // namespace gonio::drivers
