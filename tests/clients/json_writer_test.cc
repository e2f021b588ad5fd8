#include "clients/visum/common/json_writer.h"

#include <gtest/gtest.h>

#include <limits>

namespace visum::cli {
namespace {

TEST(JsonWriter, WritesNestedObjectsAndArrays) {
  JsonWriter json;
  json.begin_object()
      .member("port", 1500)
      .member("ready", true)
      .key("parts")
      .begin_array()
      .value("arm")
      .value(1.5);
  json.begin_object().end_object().end_array().member("last", std::string("x")).end_object();
  EXPECT_EQ(json.text(), R"({"port":1500,"ready":true,"parts":["arm",1.5,{}],"last":"x"})");
}

TEST(JsonWriter, EscapesWhatJsonDemands) {
  JsonWriter json;
  json.value(std::string_view("a\"b\\c\nd\x01\x7f"));
  EXPECT_EQ(json.text(), "\"a\\\"b\\\\c\\nd\\u0001\\u007f\"");
}

TEST(JsonWriter, NumbersThatAreNoneBecomeNull) {
  JsonWriter json;
  json.begin_array().value(std::numeric_limits<double>::quiet_NaN());
  json.value(-std::numeric_limits<double>::infinity()).end_array();
  EXPECT_EQ(json.text(), "[null,null]");
}

TEST(JsonWriter, KeepsLargeIntegersWhole) {
  JsonWriter json;
  json.value(std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(json.text(), "18446744073709551615");
}

}  // namespace
}  // namespace visum::cli
