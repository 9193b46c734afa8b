#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <igtlCapabilityMessage.h>
#include <igtlClientSocket.h>
#include <igtlImageMessage.h>
#include <igtlMessageHeader.h>
#include <igtlPolyDataMessage.h>
#include <igtlSensorMessage.h>
#include <igtlStatusMessage.h>
#include <igtlTransformMessage.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace sulcus::test {

/// A port of this machine that nobody has at the moment.
inline int free_tcp_port() {
  const int probe = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  EXPECT_EQ(bind(probe, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
  EXPECT_EQ(getsockname(probe, reinterpret_cast<sockaddr*>(&address), &size), 0);
  close(probe);
  return ntohs(address.sin_port);
}

/// What has come under one device name, message for message. Of SENSOR and TRANSFORM (its first
/// three rows) the numbers, of STATUS its words.
struct ReadMessages {
  std::string type;
  std::vector<std::uint64_t> stamps;  // 2^-32 s
  std::vector<std::vector<double>> numbers;
  std::vector<std::string> words;
  std::vector<std::int64_t> codes;  // of STATUS: code, sub-code
  std::uint64_t unit = 0;           // of SENSOR
};

/// A client of a stream: socket, headers, check sums and bodies are those of OpenIGTLink's own
/// library, as its example receiver uses them.
class StreamReader {
 public:
  explicit StreamReader(int port) { connected_ = socket_->ConnectToServer("127.0.0.1", port) == 0; }
  bool is_connected() const { return connected_; }
  bool ask(const std::string& bytes) {
    return socket_->Send(bytes.data(), static_cast<int>(bytes.size())) == 1;
  }
  template <class Query>
  void ask(const std::string& device) {
    const auto query = Query::New();
    query->SetDeviceName(device.c_str());
    query->Pack();
    EXPECT_EQ(socket_->Send(query->GetPackPointer(), query->GetPackSize()), 1);
  }
  /// Reads so many messages, or to the end.
  void read(std::size_t messages = ~std::size_t{0}) {
    for (; messages > 0 && read_one(); --messages) {
    }
  }
  void hang_up() { socket_->CloseSocket(); }

  std::map<std::string, ReadMessages> devices;
  std::size_t messages = 0, bodies_refused = 0, without_body = 0;
  igtl::PolyDataMessage::Pointer surface;
  igtl::ImageMessage::Pointer image;

 private:
  bool read_one() {
    const auto header = igtl::MessageHeader::New();
    header->InitPack();
    if (socket_->Receive(header->GetPackPointer(), header->GetPackSize()) !=
        header->GetPackSize()) {
      return false;
    }
    header->Unpack();
    ++messages;
    ReadMessages& device = devices[header->GetDeviceName()];
    device.type = header->GetDeviceType();
    unsigned seconds = 0, fraction = 0;
    header->GetTimeStamp(&seconds, &fraction);
    device.stamps.push_back(std::uint64_t{seconds} << 32 | fraction);
    if (header->GetBodySizeToRead() == 0) {
      ++without_body;
    } else if (device.type == "SENSOR") {
      const auto sensor = body_of<igtl::SensorMessage>(*header);
      device.unit = sensor->GetUnit();
      device.numbers.emplace_back();
      for (unsigned i = 0; i < sensor->GetLength(); ++i) {
        device.numbers.back().push_back(sensor->GetValue(i));
      }
    } else if (device.type == "TRANSFORM") {
      igtl::Matrix4x4 matrix;
      body_of<igtl::TransformMessage>(*header)->GetMatrix(matrix);
      device.numbers.emplace_back(&matrix[0][0], &matrix[0][0] + 12);
    } else if (device.type == "STATUS") {
      const auto status = body_of<igtl::StatusMessage>(*header);
      device.words.push_back(std::string(status->GetErrorName()) + ": " +
                             status->GetStatusString());
      device.codes.insert(device.codes.end(), {status->GetCode(), status->GetSubCode()});
    } else if (device.type == "POLYDATA") {
      surface = body_of<igtl::PolyDataMessage>(*header);
    } else if (device.type == "IMAGE") {
      image = body_of<igtl::ImageMessage>(*header);
    } else if (device.type == "CAPABILITY") {
      const auto capability = body_of<igtl::CapabilityMessage>(*header);
      for (const std::string& type : capability->GetTypes()) device.words.push_back(type.c_str());
    } else {
      socket_->Skip(header->GetBodySizeToRead());
    }
    return true;
  }
  template <class Message>
  typename Message::Pointer body_of(igtl::MessageHeader& header) {
    auto message = Message::New();
    message->SetMessageHeader(&header);
    message->AllocatePack();
    socket_->Receive(message->GetPackBodyPointer(), message->GetPackBodySize());
    constexpr int kCheckSum = 1;
    if (!(message->Unpack(kCheckSum) & igtl::MessageHeader::UNPACK_BODY)) ++bodies_refused;
    return message;
  }

  igtl::ClientSocket::Pointer socket_ = igtl::ClientSocket::New();
  bool connected_ = false;
};

}  // namespace sulcus::test
