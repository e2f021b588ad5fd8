#include "tests/protocol/schema.h"

#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/dynamic_message.h>
#include <google/protobuf/util/json_util.h>

#include <limits>
#include <stdexcept>

#include "tests/protocol/vectors.h"

namespace visum::testing {
namespace {

namespace pb = google::protobuf;

std::vector<std::byte> serialize(const pb::Message& message) {
  return to_bytes(message.SerializeAsString());
}

// Calls `set(value, name)` for each extreme value of the type.
template <typename T, typename Set>
void with_extremes(Set set) {
  using Limits = std::numeric_limits<T>;
  if constexpr (std::is_floating_point_v<T>) {
    set(Limits::quiet_NaN(), "nan");
    set(Limits::infinity(), "inf");
    set(-Limits::infinity(), "-inf");
    set(Limits::max() / 1.7976931348623157, "1e308 or so");
    set(Limits::denorm_min(), "denormal");
    set(-T(0), "-0");
  } else {
    set(Limits::min(), "min");
    set(Limits::max(), "max");
  }
}

class Extremes {
 public:
  Extremes(pb::Message& root, const Schema::Visit& visit) : root_(root), visit_(visit) { walk(root, ""); }

 private:
  void walk(pb::Message& message, const std::string& path) {
    const pb::Reflection& reflection = *message.GetReflection();
    std::vector<const pb::FieldDescriptor*> fields;
    reflection.ListFields(message, &fields);
    for (const pb::FieldDescriptor* field : fields) {
      const std::string name = path + field->name();
      const int count = field->is_repeated() ? reflection.FieldSize(message, field) : 1;
      for (int i = 0; i < count; ++i) visit_field(message, field, i, name);
    }
  }

  void visit_field(pb::Message& message, const pb::FieldDescriptor* field, int i, const std::string& name) {
    const pb::Reflection& r = *message.GetReflection();
    using Field = pb::FieldDescriptor;
    switch (field->cpp_type()) {
      case Field::CPPTYPE_MESSAGE:
        return walk(field->is_repeated() ? *r.MutableRepeatedMessage(&message, field, i)
                                         : *r.MutableMessage(&message, field),
                    name + ".");
      case Field::CPPTYPE_DOUBLE:
        return number<double>(message, field, i, name, &pb::Reflection::SetDouble,
                              &pb::Reflection::SetRepeatedDouble);
      case Field::CPPTYPE_FLOAT:
        return number<float>(message, field, i, name, &pb::Reflection::SetFloat,
                             &pb::Reflection::SetRepeatedFloat);
      case Field::CPPTYPE_INT64:
        return number<std::int64_t>(message, field, i, name, &pb::Reflection::SetInt64,
                                    &pb::Reflection::SetRepeatedInt64);
      case Field::CPPTYPE_UINT64:
        return number<std::uint64_t>(message, field, i, name, &pb::Reflection::SetUInt64,
                                     &pb::Reflection::SetRepeatedUInt64);
      case Field::CPPTYPE_UINT32:
        return number<std::uint32_t>(message, field, i, name, &pb::Reflection::SetUInt32,
                                     &pb::Reflection::SetRepeatedUInt32);
      case Field::CPPTYPE_ENUM:
        return number<int>(message, field, i, name, &pb::Reflection::SetEnumValue,
                           &pb::Reflection::SetRepeatedEnumValue);
      default:
        return;  // texts, bytes, flags
    }
  }

  // Sets the field to each extreme in a copy of its message, and visits the whole payload.
  template <typename T, typename Set, typename SetRepeated>
  void number(pb::Message& message, const pb::FieldDescriptor* field, int i, const std::string& name, Set set,
              SetRepeated set_repeated) {
    const pb::Reflection& reflection = *message.GetReflection();
    const std::unique_ptr<pb::Message> before(message.New());
    before->CopyFrom(message);
    with_extremes<T>([&](T value, const char* what) {
      if (field->is_repeated())
        (reflection.*set_repeated)(&message, field, i, value);
      else
        (reflection.*set)(&message, field, value);
      visit_(name + "[" + std::to_string(i) + "] = " + what, serialize(root_));
    });
    message.CopyFrom(*before);
  }

  pb::Message& root_;
  const Schema::Visit& visit_;
};

void list_unset(const pb::Message& message, const std::string& path, std::vector<std::string>& unset) {
  const pb::Reflection& reflection = *message.GetReflection();
  for (int i = 0; i < message.GetDescriptor()->field_count(); ++i) {
    const pb::FieldDescriptor* field = message.GetDescriptor()->field(i);
    const std::string name = path + field->name();
    const bool is_set =
        field->is_repeated() ? reflection.FieldSize(message, field) > 0 : reflection.HasField(message, field);
    if (!is_set && !field->containing_oneof()) unset.push_back(name);
    if (!is_set || field->cpp_type() != pb::FieldDescriptor::CPPTYPE_MESSAGE) continue;
    list_unset(field->is_repeated() ? reflection.GetRepeatedMessage(message, field, 0)
                                    : reflection.GetMessage(message, field),
               name + ".", unset);
  }
}

}  // namespace

struct Schema::Impl {
  Impl() {
    pb::FileDescriptorSet files;
    if (!files.ParseFromString(read_file(VISUM_PROTO_DESCRIPTOR)) || files.file_size() != 1 ||
        !pool.BuildFile(files.file(0)))
      throw std::runtime_error(VISUM_PROTO_DESCRIPTOR ": no description of visum.proto");
  }

  std::unique_ptr<pb::Message> make(const std::string& name) const {
    const pb::Descriptor* type = pool.FindMessageTypeByName("visum.v1." + name);
    if (!type) throw std::runtime_error("visum.proto has no message " + name);
    return std::unique_ptr<pb::Message>(factory.GetPrototype(type)->New());
  }
  std::unique_ptr<pb::Message> parse(const std::string& name, std::span<const std::byte> payload) const {
    auto message = make(name);
    if (!message->ParseFromArray(payload.data(), static_cast<int>(payload.size())))
      throw std::runtime_error("not a " + name);
    return message;
  }

  pb::DescriptorPool pool;
  mutable pb::DynamicMessageFactory factory;
};

Schema::Schema() : impl_(std::make_unique<Impl>()) {}
Schema::~Schema() = default;

std::string Schema::to_json(const std::string& name, std::span<const std::byte> payload) const {
  pb::util::JsonPrintOptions options;
  options.add_whitespace = true;
  options.preserve_proto_field_names = true;
  std::string json;
  const auto status = pb::util::MessageToJsonString(*impl_->parse(name, payload), &json, options);
  if (!status.ok()) throw std::runtime_error(status.ToString());
  return json;
}

std::vector<std::byte> Schema::to_payload(const std::string& name, const std::string& json) const {
  const auto message = impl_->make(name);
  const auto status = pb::util::JsonStringToMessage(json, message.get());
  if (!status.ok()) throw std::runtime_error(status.ToString());
  return serialize(*message);
}

void Schema::for_each_extreme(const std::string& name, std::span<const std::byte> payload,
                              const Visit& visit) const {
  const auto message = impl_->parse(name, payload);
  Extremes(*message, visit);
}

std::vector<std::string> Schema::unset_fields(const std::string& name,
                                              std::span<const std::byte> payload) const {
  std::vector<std::string> unset;
  list_unset(*impl_->parse(name, payload), "", unset);
  return unset;
}

std::vector<std::byte> to_bytes(const std::string& text) {
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  return {first, first + text.size()};
}

}  // namespace visum::testing
