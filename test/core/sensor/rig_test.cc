#include "core/sensor/rig.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <sstream>

#include "core/util/error.h"
#include "test/testing/paths.h"

namespace plumbline {
namespace {

const std::string kConfigs = ConfigsDir();

const std::string kScanner =
    "  - name: top\n    topic: /top\n"
    "    body_from_scanner: {translation: [1, 2, 3], rotation_rpy_deg: [10, 20, 30]}\n"
    "    range_noise_m: 0.03\n    min_range_m: 0.1\n    max_range_m: 30\n";

std::string TestPath() {
  return testing::TempDir() + testing::UnitTest::GetInstance()->current_test_info()->name() +
         ".yaml";
}

Rig ReadText(const std::string& text) {
  std::ofstream(TestPath()) << text;
  return ReadRig(TestPath());
}

// Reads the text as a rig file; the message without the path of the file.
std::string ErrorOf(const std::string& text) {
  try {
    ReadText(text);
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.rfind(TestPath() + ":", 0), 0u) << message;
    return message.substr(TestPath().size());
  }
  return "";
}

TEST(Rig, ReadsDefaults) {
  const Rig rig = ReadText("scanners:\n" + kScanner);
  ASSERT_EQ(rig.scanners.size(), 1u);
  EXPECT_EQ(rig.motion, MotionModel::kAutomatic);
  EXPECT_EQ(rig.scanners[0].time_offset_s, 0.0);
  EXPECT_NEAR(rig.scanners[0].angle_noise_rad, 0.005 * M_PI / 180.0, 1e-15);
  EXPECT_EQ(rig.scanners[0].beams, 270);
  EXPECT_EQ(rig.odometry_topic, "");
  EXPECT_EQ(ReadText("motion: planar\nscanners:\n" + kScanner).motion, MotionModel::kPlanar);
}

TEST(Rig, NoiseGrowsWithTheSquareOfTheRange) {
  Scanner scanner;
  scanner.range_noise_m = 0.003;
  scanner.range_noise_per_m2 = 0.001;
  EXPECT_DOUBLE_EQ(scanner.RangeStddev(0.0), 0.003);
  EXPECT_DOUBLE_EQ(scanner.RangeStddev(2.0), 0.005);
  EXPECT_DOUBLE_EQ(scanner.RangeVariance(2.0), 25e-6);
  scanner.max_range_m = 2.0;
  Rig rig;
  rig.scanners.resize(1);
  rig.scanners[0].range_noise_m = 0.004;
  rig.scanners.push_back(scanner);
  EXPECT_DOUBLE_EQ(MaxRangeNoise(rig), 0.005);
}

// To the bit, so that nothing changes for scanners of one noise.
TEST(Rig, NoiseWithoutGrowthIsTheStatedOne) {
  for (double noise_m = 1e-6; noise_m < 10.0; noise_m *= 1.01) {
    Scanner scanner;
    scanner.range_noise_m = noise_m;
    EXPECT_EQ(scanner.RangeVariance(7.3), noise_m * noise_m);
    EXPECT_EQ(scanner.RangeStddev(7.3), noise_m);
  }
}

TEST(Rig, BodysScannerIsTheFirstSteepOne) {
  Rig rig;
  rig.scanners.resize(3);
  for (Scanner& scanner : rig.scanners) scanner.uncertainty.rotation_rad = 0.01;
  const auto turn = [&](size_t scanner, double roll_deg) {
    rig.scanners[scanner].body_from_scanner.rotation =
        RotationFromRollPitchYaw(roll_deg * M_PI / 180.0, 0.0, 0.0);
  };
  EXPECT_EQ(BodyScanner(rig), 0u) << "all level";
  turn(0, 4.0);
  turn(1, 45.0);
  turn(2, 50.0);
  EXPECT_EQ(BodyScanner(rig), 1u);
  rig.motion = MotionModel::kPlanar;
  EXPECT_EQ(BodyScanner(rig), 0u);
  rig.motion = MotionModel::kAutomatic;
  turn(0, 30.0);
  EXPECT_EQ(BodyScanner(rig), 0u);
  rig.scanners[2].uncertainty = {};
  EXPECT_EQ(BodyScanner(rig), 2u) << "known exactly";
}

TEST(Rig, NoiseCanBeLeftToTheRecording) {
  std::string text = "scanners:\n" + kScanner;
  text.replace(text.find("noise_m: 0.03"), 13, "noise_m: estimate");
  const Rig rig = ReadText(text);
  EXPECT_TRUE(rig.scanners[0].estimates_noise);
  WriteRig(rig, TestPath());
  EXPECT_TRUE(ReadRig(TestPath()).scanners[0].estimates_noise);
  text.replace(text.find("noise_m: estimate"), 17, "noise_m: guess");
  EXPECT_NE(ErrorOf(text).find("range_noise_m"), std::string::npos);
}

TEST(Rig, PaperRigPointsAsDescribed) {
  for (const auto& [file, beams] : {std::pair("paper.yaml", 270), {"paper_1080.yaml", 1080}}) {
    const Rig rig = ReadRig(kConfigs + "/rigs/" + file);
    ASSERT_EQ(rig.scanners.size(), 3u);
    const double half = std::sqrt(0.5);
    const Eigen::Vector3d normals[] = {{0, 0, 1}, {0.5, 0.5, half}, {0.5, -0.5, half}};
    // The gap lies opposite to the zero beam. Of the tilted planes' directions the steepest
    // rise and fall by 45 degrees.
    const Eigen::Vector3d gaps[] = {{0, 1, 0}, {-0.5, -0.5, half}, {0.5, -0.5, -half}};
    for (size_t i = 0; i < 3; ++i) {
      const Scanner& scanner = rig.scanners[i];
      const Eigen::Quaterniond& rotation = scanner.body_from_scanner.rotation;
      EXPECT_LT((rotation * Eigen::Vector3d::UnitZ() - normals[i]).norm(), 1e-12);
      EXPECT_LT((rotation * -Eigen::Vector3d::UnitX() - gaps[i]).norm(), 1e-12);
      EXPECT_EQ(scanner.beams, beams);
      EXPECT_EQ(scanner.field_of_view_deg, 270.0);
      EXPECT_EQ(scanner.scan_rate_hz, 40.0);
      EXPECT_EQ(scanner.range_noise_m, 0.03);
      EXPECT_EQ(scanner.min_range_m, 0.1);
      EXPECT_EQ(scanner.max_range_m, 30.0);
      EXPECT_LT(scanner.body_from_scanner.translation.norm(), 0.2);
    }
    EXPECT_FALSE(AllScannersHorizontal(rig, 0.1));
  }
}

TEST(Rig, HorizontalScannersAreRecognisedUpsideDownToo) {
  Rig rig;
  rig.scanners.resize(2);
  rig.scanners[1].body_from_scanner.rotation = RotationFromRollPitchYaw(M_PI, 0.0, 0.3);
  EXPECT_TRUE(AllScannersHorizontal(rig, 1e-6));
  rig.scanners[1].body_from_scanner.rotation = RotationFromRollPitchYaw(0.0, 0.02, 0.3);
  EXPECT_FALSE(AllScannersHorizontal(rig, 0.01));
  EXPECT_TRUE(AllScannersHorizontal(rig, 0.03));
}

TEST(Rig, WrittenRigReadsBack) {
  Rig rig;
  rig.motion = MotionModel::kSpatial;
  const Eigen::Vector3d angles[] = {
      {0.1, 0.2, 0.3}, {-3.0, 1.2, 2.9}, {0.4, M_PI / 2, 0.2}, {0.4, -M_PI / 2, 0.2}};
  for (const Eigen::Vector3d& rpy : angles) {
    Scanner scanner;
    scanner.name = "a \"quoted\" name " + std::to_string(rig.scanners.size());
    scanner.topic = "/scan" + std::to_string(rig.scanners.size());
    scanner.body_from_scanner = {RotationFromRollPitchYaw(rpy.x(), rpy.y(), rpy.z()),
                                 Eigen::Vector3d(0.1, -0.2, 1.0 / 3.0)};
    scanner.range_noise_m = 0.012;
    scanner.angle_noise_rad = 1e-3;
    scanner.time_offset_s = -0.0123;
    scanner.range_bias_m = 0.004;
    scanner.range_scale = 1.002;
    scanner.uncertainty.range_scale = 0.001;
    scanner.beams = 541;
    scanner.field_of_view_deg = 190.5;
    scanner.scan_rate_hz = 25.0;
    if (rig.scanners.empty()) {  // the others leave the headers of the messages as they are
      scanner.time_increment_s = -0.0001;
      scanner.angle_min_rad = -1.5;
      scanner.angle_increment_rad = 0.0078125;
    }
    rig.scanners.push_back(scanner);
  }
  rig.odometry_topic = "/wheels";
  rig.odometry_time_offset_s = -0.05;
  WriteRig(rig, TestPath());
  const Rig read = ReadRig(TestPath());
  ASSERT_EQ(read.scanners.size(), rig.scanners.size());
  EXPECT_EQ(read.motion, rig.motion);
  EXPECT_EQ(read.odometry_topic, rig.odometry_topic);
  EXPECT_EQ(read.odometry_time_offset_s, rig.odometry_time_offset_s);
  // What is not stated is not written, either.
  rig.odometry_time_offset_s.reset();
  WriteRig(rig, TestPath());
  EXPECT_FALSE(ReadRig(TestPath()).odometry_time_offset_s);
  for (size_t i = 0; i < rig.scanners.size(); ++i) {
    const Scanner& expected = rig.scanners[i];
    const Scanner& scanner = read.scanners[i];
    EXPECT_EQ(scanner.name, expected.name);
    EXPECT_EQ(scanner.topic, expected.topic);
    EXPECT_EQ(scanner.body_from_scanner.translation, expected.body_from_scanner.translation);
    EXPECT_LT(scanner.body_from_scanner.rotation.angularDistance(
                  expected.body_from_scanner.rotation),
              1e-7);
    EXPECT_EQ(scanner.range_noise_m, expected.range_noise_m);
    EXPECT_NEAR(scanner.angle_noise_rad, expected.angle_noise_rad, 1e-15);
    EXPECT_EQ(scanner.time_offset_s, expected.time_offset_s);
    EXPECT_EQ(scanner.range_bias_m, expected.range_bias_m);
    EXPECT_EQ(scanner.range_scale, expected.range_scale);
    EXPECT_EQ(scanner.uncertainty.range_scale, expected.uncertainty.range_scale);
    EXPECT_EQ(scanner.beams, expected.beams);
    EXPECT_EQ(scanner.field_of_view_deg, expected.field_of_view_deg);
    EXPECT_EQ(scanner.scan_rate_hz, expected.scan_rate_hz);
    EXPECT_EQ(scanner.time_increment_s, expected.time_increment_s);
    ASSERT_EQ(scanner.angle_min_rad.has_value(), expected.angle_min_rad.has_value());
    ASSERT_EQ(scanner.angle_increment_rad.has_value(),
              expected.angle_increment_rad.has_value());
    if (!expected.angle_min_rad) continue;
    EXPECT_NEAR(*scanner.angle_min_rad, *expected.angle_min_rad, 1e-12);
    EXPECT_NEAR(*scanner.angle_increment_rad, *expected.angle_increment_rad, 1e-15);
  }
}

const std::string kImu =
    "imu:\n"
    "  topic: /imu\n"
    "  body_from_imu: {translation: [0.1, 0.2, 0.3], rotation_rpy_deg: [0, 0, 90]}\n"
    "  gyroscope: {noise_deg_s_sqrt_hz: 0.005, range_deg_s: 250}\n"
    "  accelerometer: {noise_ug_sqrt_hz: 400, bias_instability_ug: 50}\n";

TEST(Rig, AnImuIsReadInTheUnitsOfDataSheets) {
  const Rig rig = ReadText("scanners:\n" + kScanner + kImu);
  ASSERT_TRUE(rig.imu);
  const Imu& imu = *rig.imu;
  EXPECT_EQ(imu.topic, "/imu");
  EXPECT_EQ(imu.body_from_imu.translation, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_NEAR(imu.gyroscope.noise, 0.005 * M_PI / 180.0, 1e-12);
  EXPECT_NEAR(imu.gyroscope.range, 250.0 * M_PI / 180.0, 1e-9);
  EXPECT_NEAR(imu.gyroscope.bias_instability, 20.0 / 3600.0 * M_PI / 180.0, 1e-12);
  EXPECT_NEAR(imu.accelerometer.noise, 400e-6 * 9.80665, 1e-12);
  EXPECT_NEAR(imu.accelerometer.bias_instability, 50e-6 * 9.80665, 1e-12);
  EXPECT_NEAR(imu.accelerometer.bias, 0.05 * 9.80665, 1e-12);
  EXPECT_TRUE(std::isinf(imu.accelerometer.range));
  EXPECT_NEAR(imu.rotation_rad, M_PI / 180.0, 1e-12);
  EXPECT_FALSE(ReadText("scanners:\n" + kScanner).imu);
}

TEST(Rig, AnImuIsWrittenAsItWasRead) {
  Rig rig = ReadText("scanners:\n" + kScanner + kImu);
  rig.imu->time_offset_s = -0.012;
  rig.imu->time_s = 0.003;
  WriteRig(rig, TestPath());
  const Rig read = ReadRig(TestPath());
  ASSERT_TRUE(read.imu);
  EXPECT_EQ(read.imu->topic, rig.imu->topic);
  EXPECT_EQ(read.imu->time_offset_s, rig.imu->time_offset_s);
  EXPECT_EQ(read.imu->time_s, rig.imu->time_s);
  EXPECT_LT(read.imu->body_from_imu.rotation.angularDistance(rig.imu->body_from_imu.rotation),
            1e-7);
  const auto expect_same = [](const InertialErrors& a, const InertialErrors& b) {
    EXPECT_NEAR(a.noise / b.noise, 1.0, 1e-12);
    EXPECT_NEAR(a.bias_instability / b.bias_instability, 1.0, 1e-12);
    EXPECT_NEAR(a.bias / b.bias, 1.0, 1e-12);
    EXPECT_EQ(a.scale, b.scale);
    if (std::isfinite(b.range)) {
      EXPECT_NEAR(a.range / b.range, 1.0, 1e-12);
    }
    EXPECT_EQ(std::isfinite(a.range), std::isfinite(b.range));
  };
  expect_same(read.imu->gyroscope, rig.imu->gyroscope);
  expect_same(read.imu->accelerometer, rig.imu->accelerometer);
}

// A scanner's text with a mount.
std::string Mounted(const std::string& mount) { return "scanners:\n" + kScanner + mount; }

TEST(Rig, AMountIsReadAndWritten) {
  Rig rig =
      ReadText(Mounted("    mount:\n"
                       "      axis: [0, 2, 0]\n"
                       "      joint_topic: /joint_states\n"
                       "      joint: nod\n"
                       "      swing: {amplitude_deg: 30, period_s: 0.8, phase_deg: 90}\n"
                       "      zero_deg: 5\n"
                       "      time_offset_s: 0.01\n"
                       "      uncertainty: {zero_deg: 2, point_m: 0.02}\n"));
  for (int round = 0; round < 2; ++round) {
    ASSERT_TRUE(rig.scanners[0].mount);
    const Mount& mount = *rig.scanners[0].mount;
    EXPECT_EQ(mount.axis, Eigen::Vector3d(0.0, 1.0, 0.0));
    EXPECT_EQ(mount.point, rig.scanners[0].body_from_scanner.translation);
    EXPECT_EQ(mount.joint_topic, "/joint_states");
    EXPECT_EQ(mount.joint, "nod");
    ASSERT_TRUE(mount.swing);
    EXPECT_NEAR(mount.swing->amplitude_rad, M_PI / 6.0, 1e-12);
    EXPECT_EQ(mount.swing->period_s, 0.8);
    EXPECT_NEAR(mount.swing->phase_rad, M_PI / 2.0, 1e-12);
    EXPECT_NEAR(mount.zero_rad, 5.0 * M_PI / 180.0, 1e-12);
    EXPECT_EQ(mount.time_offset_s, 0.01);
    EXPECT_NEAR(mount.uncertainty.zero_rad, 2.0 * M_PI / 180.0, 1e-12);
    EXPECT_EQ(mount.uncertainty.point_m, 0.02);
    EXPECT_EQ(mount.uncertainty.time_s, 0.002);
    EXPECT_EQ(mount.uncertainty.rate, 0.0) << "the angle is read";
    WriteRig(rig, TestPath());
    rig = ReadRig(TestPath());
  }
  rig = ReadText(Mounted("    mount: {axis: [0, 0, 1], point: [1, 2, 3], rate_deg_s: -90}\n"));
  for (int round = 0; round < 2; ++round) {
    ASSERT_TRUE(rig.scanners[0].mount);
    EXPECT_EQ(rig.scanners[0].mount->point, Eigen::Vector3d(1.0, 2.0, 3.0));
    EXPECT_NEAR(rig.scanners[0].mount->rate_rad_s, -M_PI / 2.0, 1e-12);
    EXPECT_EQ(rig.scanners[0].mount->uncertainty.rate, 0.001);
    EXPECT_FALSE(rig.scanners[0].mount->swing);
    WriteRig(rig, TestPath());
    rig = ReadRig(TestPath());
  }
}

TEST(Rig, ErrorsOfMountsNameTheLine) {
  EXPECT_EQ(ErrorOf(Mounted("    mount: {axis: [0, 0, 0], rate_deg_s: 1}\n")),
            ":8: axis must not be of length 0");
  EXPECT_EQ(ErrorOf(Mounted("    mount: {axis: [0, 0, 1]}\n")),
            ":8: a mount needs a joint_topic, a rate_deg_s or a swing");
  EXPECT_EQ(ErrorOf(Mounted("    mount: {axis: [0, 0, 1], rate_deg_s: 1, joint: tilt}\n")),
            ":8: joint names one of the joints in the messages of a joint_topic");
  EXPECT_EQ(ErrorOf(Mounted("    mount:\n      axis: [0, 0, 1]\n      rate_deg_s: 1\n"
                            "      swing: {amplitude_deg: 1, period_s: 1}\n")),
            ":11: give either rate_deg_s or swing, not both");
  EXPECT_EQ(ErrorOf(Mounted("    mount: {axis: [0, 0, 1], rate_deg_s: 1, speed: 2}\n")),
            ":8: unknown key 'speed'");
}

TEST(Rig, AScannerThatNodsSeesHeightsAndIsNotTheBodys) {
  const std::string swing = "swing: {amplitude_deg: 30, period_s: 1}";
  Rig rig = ReadText(Mounted("    mount: {axis: [0, 1, 0], " + swing + "}\n"));
  rig.scanners[0].body_from_scanner.rotation.setIdentity();
  EXPECT_FALSE(IsPlanar(rig));
  rig.scanners[0].mount->axis = Eigen::Vector3d::UnitZ();
  EXPECT_TRUE(IsPlanar(rig)) << "it turns in its own plane";
  rig.scanners.push_back(rig.scanners[0]);
  EXPECT_EQ(BodyScanner(rig), 0u) << "all are on mounts";
  rig.scanners[1].mount.reset();
  EXPECT_EQ(BodyScanner(rig), 1u);
  rig.scanners[0].mount->axis = Eigen::Vector3d::UnitY();
  EXPECT_EQ(BodyScanner(rig), 1u);
}

TEST(Rig, UnwritablePathIsNamed) {
  Rig rig;
  rig.scanners.resize(1);
  try {
    WriteRig(rig, "no/such/rig.yaml");
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.rfind("no/such/rig.yaml: can not be written", 0), 0u) << message;
  }
}

TEST(Rig, ErrorsNameTheLine) {
  std::string other = kScanner;
  other.replace(other.find("top"), 3, "two");
  EXPECT_EQ(ErrorOf("scanners: []\n"), ":1: the rig has no scanner");
  EXPECT_EQ(ErrorOf("motions: planar\nscanners:\n" + kScanner), ":1: unknown key 'motions'");
  EXPECT_EQ(ErrorOf("motion: flat\nscanners:\n" + kScanner),
            ":1: 'motion' must be one of: automatic, spatial, planar");
  EXPECT_EQ(ErrorOf("scanners:\n" + kScanner + kScanner),
            ":8: a scanner named 'top' stands above already");
  EXPECT_EQ(ErrorOf("scanners:\n" + kScanner + other),
            ":9: topic '/top' belongs to a scanner above already");
  EXPECT_EQ(ErrorOf("scanners:\n" + kScanner + "    colour: red\n"),
            ":8: unknown key 'colour'");
  EXPECT_EQ(ErrorOf("scanners:\n" + kScanner + "    angle_increment_deg: 0\n"),
            ":8: angle_increment_deg must not be 0");
  EXPECT_EQ(ErrorOf("scanners:\n" + kScanner + kImu + "  gyro: 1\n"),
            ":13: unknown key 'gyro'");
  EXPECT_EQ(ErrorOf("scanners:\n" + kScanner + kImu + "  uncertainty: {range_m: 0.1}\n"),
            ":13: an IMU measures no ranges");
  std::string swapped = kScanner;
  swapped.replace(swapped.find("max_range_m: 30"), 15, "max_range_m: .1");
  EXPECT_EQ(ErrorOf("scanners:\n" + swapped), ":6: min_range_m must be less than max_range_m");
}

}  // namespace
}  // namespace plumbline
