#pragma once
// All settings of the service: those of the pipeline and one struct for each part around it. Defaults live in the
// structs; keys and ranges in service_fields.cpp; every key with its comment in config/pelorus.yaml. Pure data.

#include <string>

#include "core/pipeline/config.h"
#include "firmware-host/runtime/camera_config.h"
#include "services/can/can_settings.h"
#include "services/recorder_config.h"
#include "services/service_settings.h"

namespace pelorus {

// Where stereo pairs come from.
struct SourceConfig {
  std::string kind = "replay";  // replay: a recorded data set; synthetic: a scene, rendered live;
                                // aravis: GigE Vision cameras; v4l2: Video4Linux devices
  std::string path;             // data-set folder, or scene file
  std::string calibration;      // file that replaces the source's own; empty = its own; live cameras need one
  double rate_hz = 0;           // pairs follow each other at this rate; 0 = at their recorded times
  bool repeat = false;          // recorded pairs start anew at their end; else the service ends there
};

struct ServiceConfig {
  SourceConfig source;
  CameraConfig camera;
  TimingConfig timing;
  MountingConfig mounting;
  CaptureWatchConfig capture;
  LcmConfig lcm;
  CanConfig can;
  RecorderConfig recorder;
  ProcessConfig process;
  PipelineConfig pipeline;
};

}  // namespace pelorus
