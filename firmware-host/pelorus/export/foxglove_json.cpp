#include "firmware-host/pelorus/export/foxglove_json.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "firmware-host/pelorus/json_object.h"

namespace pelorus::foxglove {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

// --- Schemas, put together from types.

std::string type(const char* name) { return JsonObject().text("type", name).str(); }

std::string object(const JsonObject& properties) {
  return JsonObject().text("type", "object").raw("properties", properties.str()).str();
}

std::string array_of(const std::string& items) { return JsonObject().text("type", "array").raw("items", items).str(); }

std::string numbers(std::initializer_list<const char*> names) {
  JsonObject properties;
  for (const char* name : names) properties.raw(name, type("number"));
  return object(properties);
}

// Times and durations are {sec, nsec}.
std::string time_type() { return object(JsonObject().raw("sec", type("integer")).raw("nsec", type("integer"))); }

std::string pose_type() {
  return object(
      JsonObject().raw("position", numbers({"x", "y", "z"})).raw("orientation", numbers({"x", "y", "z", "w"})));
}

std::string entity_type() {
  const std::string color = numbers({"r", "g", "b", "a"});
  const std::string cube =
      object(JsonObject().raw("pose", pose_type()).raw("size", numbers({"x", "y", "z"})).raw("color", color));
  const std::string text = object(JsonObject()
                                      .raw("pose", pose_type())
                                      .raw("billboard", type("boolean"))
                                      .raw("font_size", type("number"))
                                      .raw("scale_invariant", type("boolean"))
                                      .raw("color", color)
                                      .raw("text", type("string")));
  JsonObject entity;
  entity.raw("timestamp", time_type())
      .raw("frame_id", type("string"))
      .raw("id", type("string"))
      .raw("lifetime", time_type())
      .raw("frame_locked", type("boolean"))
      .raw("metadata", array_of(object(JsonObject().raw("key", type("string")).raw("value", type("string")))));
  for (const char* unused : {"arrows", "spheres", "cylinders", "lines", "triangles", "models"}) {
    entity.raw(unused, array_of(type("object")));
  }
  return object(entity.raw("cubes", array_of(cube)).raw("texts", array_of(text)));
}

std::string deletion_type() {
  return object(JsonObject().raw("timestamp", time_type()).raw("type", type("integer")).raw("id", type("string")));
}

// --- Values.

std::string time_value(std::int64_t ns) {
  return JsonObject().integer("sec", ns / kSecond_ns).integer("nsec", ns % kSecond_ns).str();
}

std::string vector_value(const Eigen::Vector3d& v) {
  return JsonObject().number("x", v.x()).number("y", v.y()).number("z", v.z()).str();
}

std::string rotation_value(const Rigid3& T) {
  Eigen::Quaterniond q = Eigen::Quaterniond(T.linear()).normalized();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  return JsonObject().number("x", q.x()).number("y", q.y()).number("z", q.z()).number("w", q.w()).str();
}

std::string pose_value(const Rigid3& T) {
  return JsonObject().raw("position", vector_value(T.translation())).raw("orientation", rotation_value(T)).str();
}

// A few colors that stay with a body's number.
std::string color_value(BodyId body, double alpha) {
  constexpr std::array<std::array<double, 3>, 6> kColors = {{{0.90, 0.35, 0.20},
                                                             {0.20, 0.55, 0.90},
                                                             {0.95, 0.75, 0.15},
                                                             {0.35, 0.75, 0.35},
                                                             {0.70, 0.40, 0.85},
                                                             {0.25, 0.75, 0.75}}};
  const auto& c = kColors[static_cast<std::size_t>(std::max(0, body.value)) % kColors.size()];
  return JsonObject().number("r", c[0]).number("g", c[1]).number("b", c[2]).number("a", alpha).str();
}

std::string entity_value(const EstimatedFrame& frame, const EstimatedObject& object) {
  Rigid3 T_world_box = object.T_world_obj;  // the box has the object's axes and is about its points
  T_world_box.translation() = object.centroid_world;
  const bool sure = object.phase == ObjectPhase::confirmed;
  constexpr double kLeastSide_m = 0.02;
  const std::string cube = JsonObject()
                               .raw("pose", pose_value(T_world_box))
                               .raw("size", vector_value(object.extent_m.cwiseMax(kLeastSide_m)))
                               .raw("color", color_value(object.id, sure ? 0.5 : 0.2))
                               .str();
  const std::string text =
      JsonObject()
          .raw("pose", pose_value(T_world_box))
          .flag("billboard", true)
          .number("font_size", 14)
          .flag("scale_invariant", true)
          .raw("color", color_value(object.id, 1))
          .text("text", std::to_string(object.id.value) + (sure ? "" : std::string(" ") + to_text(object.phase)))
          .str();
  const auto fact = [](const char* key, const std::string& value) {
    return JsonObject().text("key", key).text("value", value).str();
  };
  JsonObject entity;
  entity.raw("timestamp", time_value(frame.capture_time.ns))
      .text("frame_id", "world")
      .text("id", body_frame(object.id))
      .raw("lifetime", time_value(0))
      .flag("frame_locked", true)
      .raw("metadata",
           json_array({fact("phase", to_text(object.phase)), fact("points", std::to_string(object.points))}));
  for (const char* unused : {"arrows", "spheres", "cylinders", "lines", "triangles", "models"}) {
    entity.raw(unused, "[]");
  }
  return entity.raw("cubes", json_array({cube})).raw("texts", json_array({text})).str();
}

}  // namespace

std::string body_frame(BodyId body) { return "body_" + std::to_string(body.value); }

std::string schema_of(const std::string& name) {
  JsonObject p;
  if (name != "pelorus.Frame" && name != "foxglove.SceneUpdate") p.raw("timestamp", time_type());
  if (name == "foxglove.PoseInFrame") p.raw("frame_id", type("string")).raw("pose", pose_type());
  if (name == "foxglove.FrameTransform") {
    p.raw("parent_frame_id", type("string"))
        .raw("child_frame_id", type("string"))
        .raw("translation", numbers({"x", "y", "z"}))
        .raw("rotation", numbers({"x", "y", "z", "w"}));
  }
  if (name == "foxglove.SceneUpdate") {
    p.raw("deletions", array_of(deletion_type())).raw("entities", array_of(entity_type()));
  }
  if (name == "pelorus.Frame") {
    p.raw("seq", type("integer")).raw("state", type("integer")).raw("state_text", type("string"));
    p.raw("pose_valid", type("boolean")).raw("world_confidence", type("number"));
    for (const char* count : {"reset_counter", "frames_missed", "objects", "objects_confirmed"}) {
      p.raw(count, type("integer"));
    }
  }
  return JsonObject().text("title", name).text("type", "object").raw("properties", p.str()).str();
}

std::string pose_in_frame(Timestamp time, const std::string& frame, const Rigid3& T_frame_x) {
  return JsonObject()
      .raw("timestamp", time_value(time.ns))
      .text("frame_id", frame)
      .raw("pose", pose_value(T_frame_x))
      .str();
}

std::string frame_transform(Timestamp time, const std::string& parent, const std::string& child,
                            const Rigid3& T_parent_child) {
  return JsonObject()
      .raw("timestamp", time_value(time.ns))
      .text("parent_frame_id", parent)
      .text("child_frame_id", child)
      .raw("translation", vector_value(T_parent_child.translation()))
      .raw("rotation", rotation_value(T_parent_child))
      .str();
}

std::string scene_update(const EstimatedFrame& frame) {
  constexpr int kAll = 1;  // SceneEntityDeletionType ALL: of this topic
  std::vector<std::string> entities;
  for (const EstimatedObject& object : frame.objects) {
    if (object.phase != ObjectPhase::ended) entities.push_back(entity_value(frame, object));
  }
  const std::string all =
      JsonObject().raw("timestamp", time_value(frame.capture_time.ns)).integer("type", kAll).text("id", "").str();
  return JsonObject().raw("deletions", json_array({all})).raw("entities", json_array(entities)).str();
}

std::string frame_facts(const EstimatedFrame& frame) {
  const auto confirmed = std::count_if(frame.objects.begin(), frame.objects.end(), [](const EstimatedObject& object) {
    return object.phase == ObjectPhase::confirmed;
  });
  return JsonObject()
      .integer("seq", static_cast<long long>(frame.seq))
      .integer("state", static_cast<int>(frame.state))
      .text("state_text", to_text(frame.state))
      .flag("pose_valid", frame.T_world_cam.has_value())
      .number("world_confidence", frame.world_confidence)
      .integer("reset_counter", frame.reset_counter)
      .integer("frames_missed", frame.frames_missed)
      .integer("objects", static_cast<long long>(frame.objects.size()))
      .integer("objects_confirmed", confirmed)
      .str();
}

}  // namespace pelorus::foxglove
