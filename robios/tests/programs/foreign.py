"""A module of somebody else's: finds the library by its plain name and takes every function that published ones take."""

import ctypes
import time

lib = ctypes.CDLL("libeyesim.so")
names = """
ANALOGRead ANALOGVoltage AUBeep AUDone AUMicrophone AUPlay CAMGet CAMGetGray CAMInit CAMRelease DIGITALRead
DIGITALReadAll DIGITALSetup DIGITALWrite ENCODERRead ENCODERReset IPCol2Gray IPCol2HSI IPGray2Col IPLaplace
IPOverlay IPOverlayGray IPPCol2HSI IPPCol2RGB IPPRGB2Col IPPRGB2HSI IPPRGB2Hue IPRGB2Col IPReadFile IPSetSize
IPSobel IPWriteFile IPWriteFileGray IRTVGet KEYGet KEYGetXY KEYRead KEYReadXY KEYWait LCDArea LCDCircle LCDClear
LCDGetPixel LCDGetPos LCDGetSize LCDImage LCDImageBinary LCDImageGray LCDImageSize LCDImageStart LCDLine LCDMenu
LCDMenuI LCDPixel LCDPrintf LCDRefresh LCDSetColor LCDSetFont LCDSetFontSize LCDSetMode LCDSetPos LCDSetPrintf
LIDARGet LIDARSet MOTORDrive MOTORDriveRaw MOTORPID MOTORPIDOff MOTORPIDoff MOTORSpeed OSAttachTimer OSDetachTimer
OSExecute OSGetCount OSGetTime OSMachineID OSMachineName OSMachineSpeed OSMachineType OSVersion OSVersionIO OSWait
PSDGet PSDGetRaw RADIOCheck RADIOGetID RADIOInit RADIOReceive RADIORelease RADIOSend RADIOStatus SERCheck SERClose
SERFlush SERInit SERReceive SERReceiveChar SERSend SERSendChar SERVODone SERVOGet SERVORange SERVOSet SERVOSetAngle
SERVOSetExtension SERVOSetRaw SERVOStalled SERVOWait SIMGetObject SIMGetPose SIMGetRobot SIMLaserScan SIMSetObject
SIMSetPose SIMSetRobot VWCurve VWDone VWDrive VWGetPosition VWGetSpeed VWRemain VWSetPosition VWSetSpeed VWStalled
VWStraight VWTurn VWWait
"""
for name in names.split():
    getattr(lib, name)
assert ctypes.c_int.in_dll(lib, "LIDAR_RESOLUTION").value == 360

lib.CAMInit(0)
image = (ctypes.c_byte * ctypes.c_int.in_dll(lib, "CAMSIZE").value)()
assert lib.CAMGet(image) == 0 and lib.LCDImage(image) == 0
start = lib.OSGetCount()
time.sleep(3)
assert abs(lib.OSGetCount() - start - 3000) < 10
lib.LCDPrintf(b"%s %d\n", b"number", 7)
