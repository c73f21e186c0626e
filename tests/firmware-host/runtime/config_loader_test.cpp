#include "firmware-host/runtime/config_loader.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <string>

#include "firmware-host/runtime/config_fields.h"
#include "tests/firmware-host/runtime/config_file.h"

namespace pelorus {
namespace {

using test::ConfigFile;

double value_of(const ConfigField& field) {
  if (std::string* const* words = std::get_if<std::string*>(&field.value)) {
    return static_cast<double>(std::hash<std::string>{}(**words) & 0xFFFFFU);  // only compared
  }
  if (bool* const* flag = std::get_if<bool*>(&field.value)) return **flag ? 1 : 0;
  if (int* const* whole = std::get_if<int*>(&field.value)) return **whole;
  if (float* const* number = std::get_if<float*>(&field.value)) return static_cast<double>(**number);
  return *std::get<double*>(field.value);
}

// Another legal value than the present one.
void move_value(const ConfigField& field) {
  if (bool* const* flag = std::get_if<bool*>(&field.value)) **flag = !**flag;
  if (std::string* const* words = std::get_if<std::string*>(&field.value)) **words += "other";
  const double other = value_of(field) == field.low ? field.high : field.low;
  if (int* const* whole = std::get_if<int*>(&field.value)) **whole = static_cast<int>(other);
  if (float* const* number = std::get_if<float*>(&field.value)) **number = static_cast<float>(other);
  if (double* const* number = std::get_if<double*>(&field.value)) **number = other;
}

std::string name_of(const ConfigField& field) { return std::string(field.section) + "." + std::string(field.key); }

std::vector<ConfigField> all_fields(ServiceConfig& config) {
  std::vector<ConfigField> fields = service_fields(config);
  for (ConfigField& field : config_fields(config.pipeline)) fields.push_back(std::move(field));
  return fields;
}

// Starting from settings that are all wrong, the file leads back to the defaults: it holds every key, rightly.
TEST(ShippedConfig, RepeatsEveryDefault) {
  ServiceConfig moved;
  for (const ConfigField& field : all_fields(moved)) move_value(field);
  const Result<Ok> outcome = apply_config_files({PELORUS_SOURCE_DIR "/config/pelorus.yaml"}, moved);
  ASSERT_TRUE(outcome.ok()) << outcome.error().message();
  ServiceConfig defaults;
  const std::vector<ConfigField> expected = all_fields(defaults);
  const std::vector<ConfigField> loaded = all_fields(moved);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_FLOAT_EQ(static_cast<float>(value_of(loaded[i])), static_cast<float>(value_of(expected[i])))
        << name_of(expected[i]) << ": config/pelorus.yaml and the default in the code differ";
  }
}

TEST(ShippedConfig, EveryOtherFileIsAccepted) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(PELORUS_SOURCE_DIR "/config")) {
    const std::string name = entry.path().filename().string();
    if (entry.path().extension() != ".yaml" || name.starts_with("stereo")) continue;  // stereo*: calibrations
    ServiceConfig config;
    const Result<Ok> outcome = apply_config_files({entry.path().string()}, config);
    EXPECT_TRUE(outcome.ok()) << outcome.error().message();
    ++files;
  }
  EXPECT_GE(files, 1);
}

TEST(ConfigFields, HaveDistinctNamesAndDefaultsInRange) {
  ServiceConfig defaults;
  std::set<std::string> names;
  std::set<const void*> places;
  for (const ConfigField& field : all_fields(defaults)) {
    EXPECT_TRUE(names.insert(name_of(field)).second) << name_of(field);
    const void* place = std::visit([](auto* value) -> const void* { return value; }, field.value);
    EXPECT_TRUE(places.insert(place).second) << name_of(field) << " fills a setting that another key fills";
    if (std::holds_alternative<bool*>(field.value)) continue;
    if (std::string* const* words = std::get_if<std::string*>(&field.value)) {
      const auto& allowed = field.words;
      EXPECT_TRUE(allowed.empty() || std::count(allowed.begin(), allowed.end(), **words) == 1) << name_of(field);
      continue;
    }
    EXPECT_LT(field.low, field.high) << name_of(field);
    EXPECT_GE(value_of(field), field.low) << name_of(field);
    EXPECT_LE(value_of(field), field.high) << name_of(field);
  }
}

struct Anything {
  template <class T>
  operator T() const;
};

// Members of an aggregate: the longest list of initializers it takes.
template <class T, class... Initializers>
constexpr std::size_t member_count() {
  if constexpr (requires { T{Initializers{}..., Anything{}}; }) {
    return member_count<T, Initializers..., Anything>();
  } else {
    return sizeof...(Initializers);
  }
}

// A setting that was added to its struct but not to the table would silently not be configurable.
TEST(ConfigFields, HoldEveryMemberOfEveryStruct) {
  constexpr std::size_t kProposal = member_count<MotionProposalConfig>();
  const std::map<std::string_view, std::size_t> expected{
      {"steps", member_count<MethodSteps>()},
      {"front_end", member_count<FrontEndConfig>() - 4},  // klt, stereo, surf, surf_match
      {"klt", member_count<KltConfig>()},
      {"stereo", member_count<StereoMatchConfig>()},
      {"surf", member_count<SurfConfig>()},
      {"surf_match", member_count<SurfMatchConfig>()},
      {"seed_points", member_count<SeedPointsConfig>()},
      {"grouping", member_count<GroupingConfig>() - 1 + kProposal},
      {"static_group", member_count<StaticGroupConfig>()},
      {"two_frame_ba", member_count<TwoFrameBaConfig>() - 1},  // adjust: steps.bundle_adjustment
      {"repartition", member_count<RepartitionConfig>()},
      {"ray_filter", member_count<RayFilterConfig>()},
      {"ego_motion", member_count<EgoMotionConfig>()},
      {"static_window", member_count<BodyWindowConfig>()},
      {"membership", member_count<MembershipConfig>() - 1 + kProposal},
      {"identity", member_count<IdentityConfig>()},
      {"merge", member_count<MergeConfig>()},
      {"reidentification", member_count<ReidentificationConfig>()},
      {"registry", member_count<RegistryConfig>() - 1 + member_count<ClustersConfig>()},
      {"object_window", member_count<BodyWindowConfig>()},
  };
  PipelineConfig defaults;
  std::map<std::string_view, std::size_t> listed;
  for (const ConfigField& field : config_fields(defaults)) ++listed[field.section];
  EXPECT_EQ(listed, expected);
  EXPECT_EQ(member_count<PipelineConfig>(), expected.size() - 4) << "a stage without a section";
}

TEST(ServiceFields, HoldEveryMemberOfEveryStruct) {
  const std::map<std::string_view, std::size_t> expected{
      {"source", member_count<SourceConfig>()},     {"camera", member_count<CameraConfig>()},
      {"timing", member_count<TimingConfig>()},     {"capture", member_count<CaptureWatchConfig>()},
      {"lcm", member_count<LcmConfig>()},           {"can", member_count<CanConfig>()},
      {"recorder", member_count<RecorderConfig>()}, {"mounting", member_count<MountingConfig>()},
      {"process", member_count<ProcessConfig>()},
  };
  ServiceConfig defaults;
  std::map<std::string_view, std::size_t> listed;
  for (const ConfigField& field : service_fields(defaults)) ++listed[field.section];
  EXPECT_EQ(listed, expected);
  EXPECT_EQ(member_count<ServiceConfig>(), expected.size() + 1) << "a part without a section";
}

TEST_F(ConfigFile, TextsTakeTheListedWordsOnly) {
  EXPECT_EQ(problems_of("source:\n  kind: synthetic\n  path: \"a: b\"\n"), "none");
  const std::string message = problems_of("source:\n  kind: replays\n  path: [a]\n");
  EXPECT_NE(message.find("did you mean 'replay'?"), std::string::npos) << message;
  EXPECT_NE(message.find(line(3)), std::string::npos) << message;
}

TEST_F(ConfigFile, ServiceAndPipelineSettingsComeFromOneFile) {
  std::ofstream(path_) << "source:\n  path: dive\nsteps:\n  net_filter: false\n";
  ServiceConfig service;
  ASSERT_TRUE(apply_config_files({path_.string()}, service).ok());
  EXPECT_EQ(service.source.path, "dive");
  EXPECT_FALSE(service.pipeline.steps.net_filter);
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

// Every number of the table set to what `value_of_key` says, all in one file.
std::string file_of_numbers(PipelineConfig config, const std::function<std::string(const ConfigField&)>& value_of_key) {
  std::string text;
  std::string_view section;
  for (const ConfigField& field : config_fields(config)) {
    if (std::holds_alternative<bool*>(field.value)) continue;
    if (field.section != section) text.append(field.section).append(":\n");
    section = field.section;
    text.append("  ").append(field.key).append(": ").append(value_of_key(field)).append("\n");
  }
  return text;
}

std::size_t count_of(const std::string& words, const std::string& text) {
  std::size_t count = 0;
  for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1)) ++count;
  return count;
}

TEST_F(ConfigFile, NumbersOutOfRangeAreRefusedForEveryKey) {
  const std::vector<ConfigField> fields = config_fields(config_);
  const auto is_number = [](const ConfigField& field) { return !std::holds_alternative<bool*>(field.value); };
  const auto numbers = static_cast<std::size_t>(std::count_if(fields.begin(), fields.end(), is_number));
  ASSERT_GT(numbers, 50U);
  const auto below = [](const ConfigField& f) { return std::to_string(std::lround(std::floor(f.low - 1))); };
  const auto above = [](const ConfigField& f) { return std::to_string(std::lround(std::floor(f.high + 1))); };
  EXPECT_EQ(count_of("out of range", problems_of(file_of_numbers(config_, below))), numbers);
  EXPECT_EQ(count_of("out of range", problems_of(file_of_numbers(config_, above))), numbers);
  for (const std::string wrong : {"1.5x", "true", "\"3\"", "[3]", "0x3", "1e999", ""}) {
    const std::string text = file_of_numbers(config_, [&](const ConfigField&) { return wrong; });
    EXPECT_EQ(count_of("without quotes", problems_of(text)), numbers) << wrong;
  }
  for (const std::string wrong : {"nan", "inf", "-inf"}) {
    const std::string text = file_of_numbers(config_, [&](const ConfigField&) { return wrong; });
    EXPECT_EQ(count_of("allowed:", problems_of(text)) + count_of("without quotes", problems_of(text)), numbers)
        << wrong;
  }
}

TEST_F(ConfigFile, CountsAreWholeNumbers) {
  const std::string message = problems_of("front_end:\n  max_points: 600.5\n");
  EXPECT_NE(message.find("a whole number"), std::string::npos) << message;
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
    const Result<Ok> outcome = apply_config_files({path.string()}, config_);
    ASSERT_FALSE(outcome.ok());
    EXPECT_EQ(outcome.error().code, ErrorCode::io);
  }
}

}  // namespace
}  // namespace pelorus
