#include "core/judging/check_picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/judging/check_text.h"
#include "test/core/judging/turning_rig.h"

namespace plumbline {
namespace {

using testing::HasSubstr;
using testing::Not;

// What plumbline_check knows of a rig, with a name that XML does not like.
CheckReport MakeReport() {
  CheckReport report;
  report.rig = MakePaperRig();
  report.survey.path = "rooms & <halls>.bag";
  report.survey.end_receipt_ns = 4'000'000'000;
  report.survey.sample = TurningRig(*report.rig).TakeLines();
  for (size_t i = 0; i < report.rig->scanners.size(); ++i) {
    TopicSurvey topic;
    topic.name = "/scan_" + std::to_string(i);
    topic.num_beams = 270;
    topic.angle_min = -2.35;
    topic.angle_increment = 0.0175;
    topic.beams.assign(270, {80, 80, 0, 0.0F, 0});
    for (int64_t i = 0; i < 4; ++i)
      topic.seconds.push_back({20, 0, 5400, 5400, 5000, 4900, i});
    report.survey.topics.push_back(topic);
    report.topics_of_scanners.push_back(static_cast<int>(i));
    report.attitudes.push_back({});
    report.heights.push_back({i > 0, {i > 0, -1.2, 1.0}, {}});
    report.corrections.push_back({});
  }
  report.findings.push_back({Severity::kStop, "/scan_1", "is \"dead\"", "wake it"});
  report.mappable = Mappable::kNot;
  report.verdict = "can not be mapped as it is";
  return report;
}

TEST(CheckPictureTest, ShowsEveryTopicAndTheRig) {
  const CheckReport report = MakeReport();
  const std::string svg = DrawCheck(report);
  EXPECT_EQ(svg, DrawCheck(report));
  EXPECT_THAT(svg, HasSubstr("rooms &amp; &lt;halls&gt;.bag"));
  EXPECT_THAT(svg, Not(HasSubstr("<halls>")));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  for (const char* text :
       {"/scan_0", "/scan_1", "/scan_2", "from above", "&quot;dead&quot;"}) {
    EXPECT_THAT(svg, HasSubstr(text));
  }
}

TEST(CheckPictureTest, LongFindingsAreBrokenIntoLines) {
  CheckReport report = MakeReport();
  std::string words;
  for (int i = 0; i < 100; ++i) words += "word" + std::to_string(i) + " ";
  report.findings.push_back({Severity::kWarning, "/scan_2", words, "the advice"});
  const std::string svg = DrawCheck(report);
  for (const char* text : {"word0 ", "word50 ", "word99", "the advice"}) {
    EXPECT_THAT(svg, HasSubstr(text));
  }
  // A line ends within the picture.
  EXPECT_THAT(svg,
              Not(HasSubstr("word0 word1 word2 word3 word4 word5 word6 word7 word8 word9 "
                            "word10 word11 word12 word13 word14 word15 word16 word17 "
                            "word18 word19 word20 word21 word22 word23 word24 word25")));
}

TEST(CheckPictureTest, ATopicWithoutLinesHasARow) {
  CheckReport report = MakeReport();
  report.survey.sample[1].clear();
  report.survey.topics[1] = TopicSurvey();
  EXPECT_THAT(DrawCheck(report), HasSubstr("no scan line"));
}

TEST(CheckTextTest, SaysVerdictFindingAndAdvice) {
  const std::string text = FormatCheckText(MakeReport());
  EXPECT_THAT(text, HasSubstr("can not be mapped as it is."));
  EXPECT_THAT(text, HasSubstr("  stop     /scan_1: is \"dead\"\n           -> wake it\n"));
  EXPECT_THAT(text, HasSubstr("sees the floor 1.20 m below the body, no ceiling"));
}

TEST(CheckTextTest, JsonHoldsTheSame) {
  const std::string json = FormatCheckJson(MakeReport());
  for (const char* text : {"\"mappable\": \"not\"",
                           "\"severity\": \"stop\"",
                           "\"sentence\": \"is \\\"dead\\\"\"",
                           "\"floor_m\": -1.2",
                           "\"ceiling_m\": null"}) {
    EXPECT_THAT(json, HasSubstr(text));
  }
}

}  // namespace
}  // namespace plumbline
