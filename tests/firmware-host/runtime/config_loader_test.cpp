#include "firmware-host/runtime/config_loader.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <set>
#include <sstream>
#include <string>

#include "firmware-host/runtime/config_fields.h"

namespace pelorus {
namespace {

class ConfigFile : public ::testing::Test {
 protected:
  ConfigFile() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::path(::testing::TempDir()) / (std::string("pelorus_") + test->name() + ".yaml");
  }
  ~ConfigFile() override { std::filesystem::remove(path_); }

  Result<Ok> apply(const std::string& text) {
    std::ofstream(path_) << text;
    return apply_config_file(path_, config_);
  }
  std::string problems_of(const std::string& text) {
    const Result<Ok> outcome = apply(text);
    return outcome ? "none" : outcome.error().message();
  }
  std::string line(int number) const { return path_.string() + ":" + std::to_string(number) + ":"; }

  std::filesystem::path path_;
  PipelineConfig config_;
};

double value_of(const ConfigField& field) {
  if (bool* const* flag = std::get_if<bool*>(&field.value)) return **flag ? 1 : 0;
  if (int* const* whole = std::get_if<int*>(&field.value)) return **whole;
  if (float* const* number = std::get_if<float*>(&field.value)) return static_cast<double>(**number);
  if (double* const* number = std::get_if<double*>(&field.value)) return **number;
  return *std::get<DegreesOf>(field.value).radians * 180 / std::numbers::pi;
}

// Another legal value than the present one.
void move_value(const ConfigField& field) {
  if (bool* const* flag = std::get_if<bool*>(&field.value)) **flag = !**flag;
  const double other = value_of(field) == field.low ? field.high : field.low;
  if (int* const* whole = std::get_if<int*>(&field.value)) **whole = static_cast<int>(other);
  if (float* const* number = std::get_if<float*>(&field.value)) **number = static_cast<float>(other);
  if (double* const* number = std::get_if<double*>(&field.value)) **number = other;
  if (const auto* angle = std::get_if<DegreesOf>(&field.value)) *angle->radians = other * std::numbers::pi / 180;
}

std::string name_of(const ConfigField& field) { return std::string(field.section) + "." + std::string(field.key); }

// Starting from settings that are all wrong, the file leads back to the defaults: it holds every key, rightly.
TEST(ShippedConfig, RepeatsEveryDefault) {
  PipelineConfig moved;
  for (const ConfigField& field : config_fields(moved)) move_value(field);
  const Result<Ok> outcome = apply_config_file(PELORUS_SOURCE_DIR "/config/pelorus.yaml", moved);
  ASSERT_TRUE(outcome.ok()) << outcome.error().message();
  PipelineConfig defaults;
  const std::vector<ConfigField> expected = config_fields(defaults);
  const std::vector<ConfigField> loaded = config_fields(moved);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_FLOAT_EQ(value_of(loaded[i]), value_of(expected[i])) << name_of(expected[i]);
  }
}

TEST(ShippedConfig, EveryOtherFileIsAccepted) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(PELORUS_SOURCE_DIR "/config")) {
    const std::string name = entry.path().filename().string();
    if (entry.path().extension() != ".yaml" || name.starts_with("stereo")) continue;  // stereo*: calibrations
    PipelineConfig config;
    const Result<Ok> outcome = apply_config_file(entry.path(), config);
    EXPECT_TRUE(outcome.ok()) << outcome.error().message();
    ++files;
  }
  EXPECT_GE(files, 1);
}

TEST(ConfigFields, HaveDistinctNamesAndDefaultsInRange) {
  PipelineConfig defaults;
  std::set<std::string> names;
  std::set<const void*> places;
  for (const ConfigField& field : config_fields(defaults)) {
    EXPECT_TRUE(names.insert(name_of(field)).second) << name_of(field);
    const void* place = std::visit(
        [](const auto& value) -> const void* {
          if constexpr (std::is_same_v<std::decay_t<decltype(value)>, DegreesOf>) {
            return value.radians;
          } else {
            return value;
          }
        },
        field.value);
    EXPECT_TRUE(places.insert(place).second) << name_of(field) << " fills a setting that another key fills";
    if (std::holds_alternative<bool*>(field.value)) continue;
    EXPECT_LT(field.low, field.high) << name_of(field);
    EXPECT_GE(value_of(field), field.low) << name_of(field);
    EXPECT_LE(value_of(field), field.high) << name_of(field);
  }
}

TEST_F(ConfigFile, ChangesOnlyWhatItLists) {
  ASSERT_TRUE(apply("steps:\n  net_filter: false\n").ok());
  EXPECT_FALSE(config_.steps.net_filter);
  EXPECT_TRUE(config_.steps.ray_filter);
}

TEST_F(ConfigFile, MayBeEmptyOrCommentedOut) {
  EXPECT_TRUE(apply("").ok());
  EXPECT_TRUE(apply("# steps:\n").ok());
  EXPECT_TRUE(apply("steps:\n  # net_filter: false\n").ok());
}

TEST_F(ConfigFile, UnknownKeyIsRefusedWithItsLineAndTheLikelyOne) {
  const std::string message = problems_of("steps:\n  net_filter: true\n  ray_filtr: true\n");
  EXPECT_NE(message.find(line(3)), std::string::npos) << message;
  EXPECT_NE(message.find("'steps.ray_filtr'"), std::string::npos) << message;
  EXPECT_NE(message.find("did you mean 'ray_filter'?"), std::string::npos) << message;
}

TEST_F(ConfigFile, UnknownSectionIsRefused) {
  const std::string message = problems_of("colours:\n  red: 1\n");
  EXPECT_NE(message.find(line(1)), std::string::npos) << message;
  EXPECT_NE(message.find("unknown section 'colours'"), std::string::npos) << message;
}

TEST_F(ConfigFile, SwitchTakesTrueOrFalseOnly) {
  for (const std::string value : {"yes", "1", "\"true\"", "[true]", "", "TRUE!"}) {
    const std::string message = problems_of("steps:\n  net_filter: " + value + "\n");
    EXPECT_NE(message.find("write true or false"), std::string::npos) << value << ": " << message;
  }
}

TEST_F(ConfigFile, NumbersOutOfRangeOrOfAnotherTypeAreRefused) {
  for (const ConfigField& field : config_fields(config_)) {
    if (std::holds_alternative<bool*>(field.value)) continue;
    const double before = value_of(field);
    const auto file = [&](const std::string& value) {
      return std::string(field.section) + ":\n  " + std::string(field.key) + ": " + value + "\n";
    };
    for (double beyond : {field.low - 1, field.high + 1, field.high * 10 + 10}) {
      const std::string message = problems_of(file(std::to_string(static_cast<long long>(std::floor(beyond)))));
      EXPECT_NE(message.find("out of range"), std::string::npos) << name_of(field) << ": " << message;
      EXPECT_NE(message.find(line(2)), std::string::npos) << message;
    }
    for (const std::string wrong : {"1.5x", "true", "\"3\"", "[3]", "0x3", "nan", "inf", "1e999", ""}) {
      EXPECT_NE(problems_of(file(wrong)), "none") << name_of(field) << ": " << wrong;
    }
    if (std::holds_alternative<int*>(field.value)) {
      EXPECT_NE(problems_of(file(std::to_string(field.low + 0.5))).find("a whole number"), std::string::npos);
    }
    EXPECT_EQ(value_of(field), before) << name_of(field) << " changed though refused";
    std::ostringstream highest;
    highest << field.high;
    EXPECT_TRUE(apply(file(highest.str())).ok()) << name_of(field) << " at its upper limit";
  }
}

TEST_F(ConfigFile, AllProblemsAreListedAndNothingIsApplied) {
  const std::string message =
      problems_of("steps:\n  net_filter: false\n  nett: true\n  ray_filter: 3\n  net_filter: true\nstepps: {}\n");
  EXPECT_NE(message.find("4 problems"), std::string::npos) << message;
  for (int number : {3, 4, 5, 6}) EXPECT_NE(message.find(line(number)), std::string::npos) << number << message;
  EXPECT_TRUE(config_.steps.net_filter);
}

TEST_F(ConfigFile, BrokenYamlNamesTheLine) {
  const std::string message = problems_of("steps:\n  net_filter: [true\n");
  EXPECT_NE(message.find("not valid YAML"), std::string::npos) << message;
  EXPECT_EQ(message.find(path_.string() + ":"), 0U) << message;
}

TEST_F(ConfigFile, OtherShapesThanSectionsAreRefused) {
  for (const std::string text : {"just words", "- a\n- b\n", "steps: 3\n", "steps: [a]\n", "{}\n---\nsteps: {}\n"}) {
    EXPECT_NE(problems_of(text), "none") << text;
  }
}

TEST_F(ConfigFile, MissingFileOrFolderIsAnInputOutputError) {
  for (const std::filesystem::path& path : {path_ / "no", std::filesystem::path(::testing::TempDir())}) {
    const Result<Ok> outcome = apply_config_file(path, config_);
    ASSERT_FALSE(outcome.ok());
    EXPECT_EQ(outcome.error().code, ErrorCode::io);
  }
}

}  // namespace
}  // namespace pelorus
